// Streams of values that parts of the page want; asked for again after the server was gone.
import { store, on, wire } from './store';
import type { Values } from './wire';

interface Wanted { topic: string; members?: string[]; hz?: number }
interface Watch { wanted: Wanted; take: (values: Values) => void }
interface ImageWatch { iface: string; take: (jpeg: Blob, time: number) => void; fail: (why: string) => void; options: object }

const watches = new Map<number, Watch>();
const images = new Map<number, ImageWatch>();
let next = 1;

function ask(id: number, { wanted }: Watch): void {
  wire.request('watch', { watch: id, ...wanted }).catch((error) => watches.get(id)?.take({ watch: id, t: [], error: error.message }));
}

export function watch(wanted: Wanted, take: (values: Values) => void): () => void {
  const id = next++;
  watches.set(id, { wanted, take });
  if (wire.status === 'open' && store.hello) ask(id, watches.get(id)!);
  return () => {
    watches.delete(id);
    if (wire.status === 'open') wire.request('unwatch', { watch: id }).catch(() => {});
  };
}

export function watch_image(iface: string, options: object, take: ImageWatch['take'], fail: ImageWatch['fail']): () => void {
  const id = next++;
  images.set(id, { iface, take, fail, options });
  if (wire.status === 'open' && store.hello) wire.request('watch_image', { watch: id, iface, ...options }).catch((error) => fail(error.message));
  return () => {
    images.delete(id);
    if (wire.status === 'open') wire.request('unwatch', { watch: id }).catch(() => {});
  };
}

wire.on('values', (values) => {
  watches.get(values.watch)?.take(values);
  if (values.error) images.get(values.watch)?.fail(values.error);
});
wire.on('image', ({ watch: id, jpeg, time }) => images.get(id)?.take(jpeg, time));
on('hello', () => {
  for (const [id, wanted] of watches) ask(id, wanted);
  for (const [id, { iface, options }] of images) wire.request('watch_image', { watch: id, iface, ...options }).catch(() => {});
});
