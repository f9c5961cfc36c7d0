// Unpacks the viewer of a page that rtse wrote, and starts it.
(async () => {
  const packed = Uint8Array.from(atob(document.getElementById('run-viewer').textContent), (c) => c.charCodeAt(0));
  const script = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer();
  await import(URL.createObjectURL(new Blob([script], { type: 'text/javascript' })));
})().catch((error) => {
  document.body.append(`This page cannot be shown: ${error.message}`);
});
