// The data blocks of a page that `rtse run --page` wrote: elements of the page, each with zlib data in base64.
const text_of = new TextDecoder();

const block = (id: string): HTMLElement | null => document.getElementById(`run-${id}`);
export const has_run = (): boolean => block('index') !== null;

// As Uint8Array.fromBase64, which older browsers do not have; a function for each octet is several times slower than this.
export function from_base64(text: string): Uint8Array<ArrayBuffer> {
  const octets = atob(text), data = new Uint8Array(octets.length);
  for (let i = 0; i < octets.length; ++i) data[i] = octets.charCodeAt(i);
  return data;
}

export async function unpacked(id: string): Promise<ArrayBuffer> {
  const element = block(id);
  if (!element) throw new Error(`this page has no block "${id}"`);
  const stream = new Blob([from_base64(element.textContent ?? '')]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}

export async function json_of(id: string): Promise<any> {
  return JSON.parse(text_of.decode(await unpacked(id)));
}

// In place of a GET of the server: the world as glTF.
export async function fetch_run(path: string): Promise<Response> {
  const id = path.includes('collisions=1') && block('collisions') ? 'collisions' : 'world';
  return block(id) ? new Response(await unpacked(id)) : new Response('this page has no world', { status: 404 });
}
