// Unpacks the viewer of a page that rtse wrote, and starts it.
(async () => {
  const octets = atob(document.getElementById('run-viewer').textContent), packed = new Uint8Array(octets.length);
  for (let i = 0; i < octets.length; ++i) packed[i] = octets.charCodeAt(i);
  const script = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer();
  await import(URL.createObjectURL(new Blob([script], { type: 'text/javascript' })));
})().catch((error) => {
  document.body.append(`This page cannot be shown: ${error.message}`);
});
