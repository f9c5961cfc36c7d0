// The right to look and act: the token of the URL that rtm-studio printed. It comes behind the '#', so no server, proxy or log sees it, leaves
// the address bar at once, and is kept by this tab alone: a cookie would be sent to every port of the host. Another tab of this browser that
// has no token asks the tabs of the same origin.
import { fetch_run, has_run } from './run_blocks';

const kept = 'rtm-studio-token';
const in_address = /(?:^#|&)token=([0-9a-f]{32})(?=&|$)/;
const answer_limit = 500; // [ms] for other tabs

function stored(): string {
  try {
    return sessionStorage.getItem(kept) ?? '';
  } catch {
    return ''; // a browser that keeps nothing
  }
}

function store(token: string): void {
  try {
    sessionStorage.setItem(kept, token);
  } catch { /* it is lost with the page */ }
}

// Of the address, out of which it is taken.
function taken(hash: string): string {
  const token = in_address.exec(hash)?.[1] ?? '';
  if (!token) return '';
  store(token);
  history.replaceState(null, '', `#${hash.slice(1).split('&').filter((part) => !part.startsWith('token=')).join('&')}`);
  return token;
}

let mine = taken(location.hash) || stored();
const tabs = new BroadcastChannel(kept);
tabs.onmessage = ({ data }) => {
  if (data === 'who has it?' && mine) tabs.postMessage({ token: mine });
};

function asked(): Promise<string> {
  return new Promise((resolve) => {
    const channel = new BroadcastChannel(kept);
    let is_late = false; // the page has begun without
    channel.onmessage = ({ data }) => {
      if (typeof data?.token !== 'string') return;
      channel.close();
      if (!is_late) return resolve(data.token);
      store(data.token);
      if (stored() === data.token) location.reload();
    };
    channel.postMessage('who has it?');
    setTimeout(() => {
      is_late = true;
      resolve('');
    }, answer_limit);
  });
}

// Empty: there is none, and nothing will be shown.
export const token: Promise<string> = mine ? Promise.resolve(mine) : asked().then((found) => {
  mine = found;
  if (found) store(found);
  return found;
});

// For a link that others can use.
export const with_token = (link: string): string => (mine ? `${link.includes('#') ? `${link}&` : `${link}#`}token=${mine}` : link).replace('#&', '#');

// Of the server, with the token; or of the run in this page.
export async function fetch_data(path: string): Promise<Response> {
  if (has_run()) return fetch_run(path);
  const right = await token;
  if (!right) throw new Error('there is no token');
  return fetch(path, { headers: { Authorization: `Bearer ${right}` }, credentials: 'omit', redirect: 'error' });
}

// A new URL in the address bar of a page that is open changes the '#' alone: the page begins again with its token. The address may be another
// already, since the page writes its view into it.
addEventListener('hashchange', ({ newURL }) => { if (taken(new URL(newURL).hash)) location.reload(); });
