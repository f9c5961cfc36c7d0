// The page: panels round the world and the system, and the keys.
import { Bottom } from './bottom';
import { Diagram } from './diagram';
import { ask_text, open_dialog } from './dialog';
import { Dock } from './dock';
import { button, h, once_a_frame, put } from './dom';
import { download } from './download';
import { Drive } from './drive';
import { History } from './history';
import { delete_model, disconnect, Inspector, put_model } from './inspector';
import type { Panel } from './layout';
import { model_menu } from './menus';
import { first_member } from './plots';
import { is_pasteable, shell_line, shell_word } from './shell';
import { apply_theme, keep, linked, settings, to_link } from './settings';
import { act, changed, component, link_problem, on, read_only, select, selected_model, state_act, store, undo_last, wire } from './store';
import { Playback, recording } from './playback';
import { profile_dialog } from './profile_dialog';
import { recordings_dialog } from './recordings_dialog';
import { has_run } from './run_blocks';
import { run_summary } from './run_summary';
import { spawn_dialog } from './spawn_dialog';
import { with_token } from './token';
import { Tree } from './tree';
import { WorldView } from './world';

const world = new WorldView();
const diagram = new Diagram();
const tree = new Tree();
const drive = new Drive();
const history_of_run = new History(world);
const playback = new Playback(() => world.trails.forget());
const bottom = new Bottom(history_of_run, playback);
function plot(topic: string, member: string): void {
  show_panel('bottom', true);
  bottom.show_tab('plots');
  bottom.plots.add(topic, member);
}
diagram.plot = (topic) => first_member(topic).then((line) => line && plot(line.topic, line.member));
world.hands.menu = (event, name) => model_menu(event, name, { follow: () => world.follow(name), put: () => put_model(world, name) });
const inspector = new Inspector({
  world,
  drive: (iface) => drive.begin(iface),
  plot,
  pause_when: (topic, members) => bottom.breaks.ask(topic, members),
  pauses_on_error: (path) => bottom.breaks.has_state(path),
  pause_on_error: (path) => bottom.breaks.toggle_state(path),
  show_image: (iface) => {
    show_panel('bottom', true);
    bottom.show_image(iface);
  },
});

world.hands.move_tips_of(inspector.joints);

// ---- top ----

const world_name = h('span', { class: 'what' });
const link_state = h('span', { class: 'link-state', role: 'status' });
const toggles = new Map<Panel, HTMLButtonElement>();
const panel_names: [Panel, string, string][] = [['tree', 'Tree', 'tree'], ['world', 'World', 'world'], ['system', 'System', 'system'], ['inspector', 'Inspector', 'inspect'], ['bottom', 'Time and plots', 'plot']];

const top_bar = h('header', { class: 'top' },
  h('h1', null, 'rtm-studio'), world_name, link_state, h('span', { class: 'spring' }),
  h('div', { class: 'toggles', role: 'toolbar', 'aria-label': 'Panels' }, panel_names.map(([panel, name, sign], i) => {
    const toggle = button(`${name} panel`, { icon: sign, key: String(i + 1), pressed: true }, () => show_panel(panel, !dock.is_front(panel)));
    toggles.set(panel, toggle);
    return toggle;
  })),
  button('Layouts of the panels', { icon: 'layout', id: 'layouts' }, (event) => dock.offer_layouts(event, (save) => ask_text('Save this layout', 'Name', '', 'Save', save))),
  button('Save the system as RTSProfile', { icon: 'save', id: 'save' }, () => save_profile()),
  button('Open an RTSProfile', { icon: 'open', id: 'open' }, () => profile_input.click()),
  button('Open a recording', { icon: 'record', key: 'R', id: 'open-recording' }, () => recordings_dialog()),
  button('Copy a link to this view (contains the access token)', { icon: 'link', id: 'copy-link' }, () => copy_link()),
  button('Light or dark', { icon: 'theme', id: 'theme' }, () => next_theme()),
  button('Keys', { icon: 'help', key: '?', id: 'help' }, () => show_keys()));

const profile_input = h('input', { type: 'file', accept: '.xml,.yaml,.yml', hidden: true, 'aria-label': 'RTSProfile' });
profile_input.addEventListener('change', async () => {
  const file = profile_input.files?.[0];
  profile_input.value = '';
  if (!file) return;
  profile_dialog(file.name, await file.text(), (positions) => diagram.place_all(positions));
});

async function save_profile(): Promise<void> {
  const result = await act('Save the system', 'save_profile', { positions: diagram.positions() });
  if (!result?.xml) return;
  download(new Blob([result.xml], { type: 'application/xml' }), `${store.world?.name || 'system'}.xml`);
  if (result.left_out) store.acts.push({ text: 'Saved, but', error: result.left_out }), changed('acts');
}

async function save_picture(): Promise<void> {
  const { width, height, ...eye } = world.eye_pose();
  const scale = Math.min(devicePixelRatio, 4096 / Math.max(width, height));
  const result = await act('Save an image', 'screenshot', { ...eye, width: Math.round(width * scale), height: Math.round(height * scale), collisions: settings.collisions });
  if (result?.png) download(new Blob([Uint8Array.from(atob(result.png), (c) => c.charCodeAt(0))], { type: 'image/png' }), `${store.world?.name || 'world'}.png`);
}

function next_theme(): void {
  const is_dark = settings.theme === 'dark' || (settings.theme === 'auto' && matchMedia('(prefers-color-scheme: dark)').matches);
  settings.theme = is_dark ? 'light' : 'dark';
  apply_theme();
  keep();
}

// ---- the world's tools ----

const tools: { [name: string]: HTMLButtonElement } = {
  whole: button('Whole world', { icon: 'whole', key: 'O' }, () => world.whole()),
  top: button('Top view', { icon: 'top', key: 'T' }, () => (world.eye.mode === 'top' ? world.whole() : world.top())),
  follow: button('Follow the selected robot', { icon: 'follow', key: 'F' }, () => follow()),
  lasers: button('Laser fans', { icon: 'laser', key: 'L', pressed: settings.lasers }, () => toggle('lasers')),
  sonars: button('Sonar cones', { icon: 'sonar', key: 'S', pressed: settings.sonars }, () => toggle('sonars')),
  trails: button('Trails', { icon: 'trail', key: 'H', pressed: settings.trails }, () => toggle('trails')),
  names: button('Names', { icon: 'names', key: 'N', pressed: settings.names }, () => toggle('names')),
  collisions: button('Collision shapes', { icon: 'shapes', key: 'B', pressed: settings.collisions }, () => toggle('collisions')),
  contacts: button('Contacts of the selected model', { icon: 'contact', key: 'K', pressed: settings.contacts }, () => toggle('contacts')),
  frames: button('Frames of the selected model, or of all moving models', { icon: 'frames', key: 'X', pressed: settings.frames }, () => toggle('frames')),
  move: button('Move models by dragging; with Ctrl they turn', { icon: 'move', key: 'M', pressed: false }, () => world.hands.set_tool('move')),
  push: button('Push models by dragging', { icon: 'push', key: 'P', pressed: false }, () => world.hands.set_tool('push')),
  picture: button('Save an image of this view, drawn by the simulator', { icon: 'camera' }, () => save_picture()),
  spawn: button('Spawn a model', { icon: 'plus', key: 'Insert' }, () => spawn_dialog((what, take) => {
    show_panel('world', true);
    act_text.textContent = `Press in the world where ${what} is to be; drag for its direction, Escape gives up`;
    world.hands.ask_place(take);
  })),
};

const camera_box = h('select', { class: 'camera-box', 'aria-label': 'Look through a camera', hidden: true });
camera_box.addEventListener('change', () => {
  if (camera_box.value) world.look_through(camera_box.value);
  else world.whole();
});

const overlays = ['lasers', 'sonars', 'trails', 'names', 'collisions', 'contacts', 'frames'] as const;

function toggle(name: (typeof overlays)[number]): void {
  settings[name] = !settings[name];
  keep();
}

function follow(): void {
  if (world.eye.mode === 'follow') return world.whole();
  const name = selected_model() ?? store.world?.ifaces.find((i) => i.type.startsWith('position'))?.model;
  if (name) world.follow(name);
}

// ---- the last act ----

const act_text = h('span', { class: 'act', role: 'status' });
const act_command = h('code', { class: 'command' });
const copy_button = button('Copy the command', { icon: 'copy', class: 'plain', id: 'copy-command' }, () => copy(act_command.textContent ?? ''));
const undo_button = button('Undo', { icon: 'undo', class: 'plain', key: 'Ctrl+Z', id: 'undo' }, () => undo_last());
const status_bar = h('footer', { class: 'status' }, undo_button, act_text, act_command, copy_button, h('span', { class: 'spring' }), h('span', { class: 'read-only' }));

on('acts', () => {
  const last = store.acts[store.acts.length - 1];
  act_text.textContent = last?.error ? `${last.text}: ${last.error}` : last?.text ?? '';
  act_text.title = act_text.textContent;
  status_bar.classList.toggle('failed', Boolean(last?.error));
  act_command.textContent = last?.command ?? '';
  act_command.title = last?.command ?? '';
  copy_button.hidden = !last?.command;
  const undo = [...store.acts].reverse().find((a) => a.undo)?.undo;
  undo_button.disabled = !undo;
  undo_button.title = undo ? `${undo.text} (Ctrl+Z)` : 'Nothing to undo';
});

// Of now: the address bar is written once a second.
function copy_link(): void {
  write_link();
  write_link.now();
  copy(with_token(location.href));
}

async function copy(text: string): Promise<void> {
  if (!is_pasteable(text)) {
    act_text.textContent = 'Not copied: the text has characters that a terminal interprets';
    return;
  }
  try {
    await navigator.clipboard.writeText(text);
    act_text.textContent = 'Copied';
  } catch {
    act_text.textContent = 'The browser rejected the copy: select the text';
  }
}

// ---- panels ----

const world_panel = h('section', { class: 'panel world-panel', 'aria-label': 'World' },
  h('div', { class: 'bar grip-place', role: 'toolbar', 'aria-label': 'World' }, h('h2', null, 'World'), tools.whole, tools.top, tools.follow, camera_box, h('span', { class: 'gap' }), tools.lasers, tools.sonars, tools.trails, tools.names, tools.collisions, tools.contacts, tools.frames, h('span', { class: 'spring' }), tools.picture, tools.move, tools.push, tools.spawn),
  world.element, drive.element);
const system_panel = h('section', { class: 'panel system-panel', 'aria-label': 'System' },
  h('div', { class: 'bar grip-place', role: 'toolbar', 'aria-label': 'System' }, h('h2', null, 'System'), h('span', { class: 'counts' }),
    button('Activate every inactive component', { icon: 'run', label: 'All', name: 'Activate all', id: 'activate-all' }, () => all_components('Inactive', 'activate', 'Activate')),
    button('Deactivate every active component', { icon: 'stop', label: 'All', name: 'Deactivate all', id: 'deactivate-all' }, () => all_components('Active', 'deactivate', 'Deactivate')),
    button('Delete the name server entries of components that exited', { icon: 'broom', id: 'forget-dead' }, () => act('Delete dead name server entries', 'forget_dead', {})), diagram.tools()),
  diagram.element);
const tree_panel = h('nav', { class: 'panel tree-panel', 'aria-label': 'Everything by name' }, tree.element);
const inspector_panel = h('section', { class: 'panel inspector-panel', 'aria-label': 'Inspector' }, h('div', { class: 'bar grip-place' }, h('h2', null, 'Inspector')), inspector.element);
const bottom_panel = h('section', { class: 'panel bottom-panel', 'aria-label': 'Time' }, bottom.element);
const tab_bar = h('div', { class: 'panel-tabs', role: 'toolbar', 'aria-label': 'Panels' }, panel_names.map(([panel, name]) => h('button', { type: 'button', 'data-panel': panel, onclick: () => show_only(panel) }, name.split(' ')[0])));
const dock = new Dock({ tree: tree_panel, world: world_panel, system: system_panel, inspector: inspector_panel, bottom: bottom_panel });
const page = h('div', { class: 'page' }, top_bar, dock.element, tab_bar, status_bar);

async function all_components(state: string, name: string, word: string): Promise<void> {
  const group = {};
  // At the same time: a component that takes long does not keep the others waiting.
  await Promise.all(store.system.components.filter((c) => c.state === state).map((one) => state_act(one, word, name, group)));
}

function lay_out(): void {
  dock.lay_out();
  for (const [panel] of panel_names) toggles.get(panel)!.setAttribute('aria-pressed', String(settings.panels[panel]));
}

function show_panel(panel: Panel, on_: boolean): void {
  settings.panels[panel] = on_;
  if (on_) dock.raise(panel);
  lay_out();
  keep();
}

// On narrow screens one panel at a time.
function show_only(panel: Panel): void {
  page.dataset.only = dock.only = panel;
  dock.lay_out();
  for (const tab of tab_bar.querySelectorAll('button')) tab.setAttribute('aria-pressed', String(tab.dataset.panel === panel));
}

// ---- what the page says of itself ----

function show_head(): void {
  const { status } = wire;
  const whole = recording();
  world_name.textContent = whole ? `${whole.file}, ${(whole.to - whole.from).toFixed(1)} s recorded` : store.world?.present ? store.world.name : '';
  const text = wire.damage ? link_problem() : status === 'no token' ? 'no token: open the URL that rtm-studio printed' : status === 'forbidden' ? 'wrong token: open the new URL' : status === 'lost' ? 'rtm-studio exited; reconnecting' : status === 'connecting' ? 'connecting' : whole ? (whole.damage ? 'the file is damaged; its readable part is shown' : '') : store.system.problem ? 'no name server' : store.world && !store.world.present ? 'no simulator' : '';
  link_state.textContent = text;
  link_state.title = whole?.damage ?? '';
  link_state.classList.toggle('bad', text !== '');
  status_bar.querySelector('.read-only')!.textContent = whole ? 'recording: read-only' : read_only() ? 'read-only: changes are rejected' : '';
  page.classList.toggle('read-only', read_only());
  undo_button.hidden = has_run();
  const counts = system_panel.querySelector('.counts')!;
  const errors = store.system.components.filter((c) => c.state === 'Error').length;
  counts.textContent = store.system.components.length > 0 ? `${errors > 0 ? `${errors} in error, ` : ''}${store.system.components.length} component${store.system.components.length === 1 ? '' : 's'}` : '';
  document.title = `${store.world?.present ? `${store.world.name} – ` : ''}rtm-studio`;
  for (const id of ['save', 'open', 'activate-all', 'deactivate-all']) (document.getElementById(id) as HTMLButtonElement | null)?.toggleAttribute('disabled', status !== 'open' || (read_only() && (id !== 'save' || whole !== undefined)));
  document.getElementById('forget-dead')!.hidden = status !== 'open' || read_only() || !store.system.components.some((c) => c.problem) && !store.system.managers.some((m) => m.problem);
  for (const tool of [tools.move, tools.push, tools.spawn]) tool.disabled = status !== 'open' || read_only() || !store.world?.present;
  for (const tool of [tools.move, tools.push, tools.spawn, tools.picture, ...['save', 'open', 'open-recording', 'copy-link', 'activate-all', 'deactivate-all'].map((id) => document.getElementById(id)!)]) tool.hidden = has_run();
  tools.picture.disabled = status !== 'open' || !store.world?.present || whole !== undefined;
}

function show_tools(): void {
  tools.top.setAttribute('aria-pressed', String(world.eye.mode === 'top'));
  tools.follow.setAttribute('aria-pressed', String(world.eye.mode === 'follow'));
  for (const name of overlays) tools[name].setAttribute('aria-pressed', String(settings[name]));
  for (const name of ['move', 'push'] as const) tools[name].setAttribute('aria-pressed', String(world.hands.tool === name));
  const cameras = world.cameras();
  if ([...camera_box.options].slice(1).map((o) => o.value).join('\n') !== cameras.join('\n')) put(camera_box, h('option', { value: '' }, 'free view'), cameras.map((c) => h('option', { value: c }, c)));
  camera_box.hidden = cameras.length === 0;
  camera_box.value = world.eye.mode === 'sensor' ? world.eye.what : '';
}

const keys: [string, string][] = [
  ['Space', 'run or pause'], ['.', 'one step'], [',', 'of a recording: one step back'], ['Shift+R', 'reset world and time; of a recording: to its beginning'], ['/', 'search'], ['1 – 5', 'panels'], ['O', 'whole world'], ['T', 'top view'], ['F', 'follow the robot'],
  ['L, S, H', 'laser fans, sonar cones, trails'], ['N, B, K, X', 'names, collision shapes, contacts, frames'], ['M, P', 'move, push by dragging'], ['Insert', 'spawn a model'], ['G', 'drive the robot (arrows or W A S D)'], ['A, D, E', 'activate, deactivate, reset the selected component'], ['C', 'connect the selected port'], ['Delete', 'cut the selected connection, delete the selected model'],
  ['Ctrl+Z', 'undo'], ['Escape', 'clear the selection'], ['Arrows', 'in the world: turn (with Shift: move); in the system: next component; in the tree: rows'], ['[  ]', 'in the system: next port'], ['+  –', 'zoom'], ['R', 'open a recording'], ['?', 'this list'],
];

const keys_of_acts = new Set(['M, P', 'Insert', 'G', 'A, D, E', 'C', 'Delete', 'Ctrl+Z', 'R']); // a page with a run in it has none of them

function show_keys(): void {
  open_dialog('Keys', h('dl', { class: 'keys' }, keys.filter(([key]) => !has_run() || !keys_of_acts.has(key)).map(([key, what]) => [h('dt', null, h('kbd', null, key)), h('dd', null, what)])), 'Close');
}

function delete_selected(): void {
  const now = store.selection;
  if (now?.kind === 'connection') disconnect(now.id);
  if (now?.kind === 'model') delete_model(now.id);
}

document.addEventListener('keydown', (event) => {
  const target = event.target as HTMLElement;
  if ((event.ctrlKey || event.metaKey) && event.key === 'z' && !target.matches('input,textarea')) {
    undo_last();
    return event.preventDefault();
  }
  if (event.ctrlKey || event.metaKey || event.altKey || target.matches('input,textarea,select')) {
    if (event.key === 'Escape' && target === tree.search) tree.search.blur();
    return;
  }
  const chosen = store.selection?.kind === 'component' ? component(store.selection.id) : undefined;
  // Whatever state the page knows of: it may be late, and the component says itself what it cannot do.
  const on_chosen = (name: string, word: string) => () => { if (chosen && !read_only()) state_act(chosen, word, name); };
  const table: { [key: string]: () => void } = {
    ' ': () => bottom.run_or_pause(), '.': () => bottom.step(), ',': () => bottom.step(-1), R: () => bottom.reset(), '/': () => { show_panel('tree', true); tree.search.focus(); tree.search.select(); }, '?': show_keys,
    o: () => world.whole(), t: () => tools.top.click(), f: follow, l: () => toggle('lasers'), n: () => toggle('names'), k: () => toggle('contacts'), s: () => toggle('sonars'), h: () => toggle('trails'), b: () => toggle('collisions'), x: () => toggle('frames'), Insert: () => tools.spawn.click(), m: () => world.hands.set_tool('move'), p: () => world.hands.set_tool('push'), g: () => drive.toggle(), r: () => { if (!has_run()) recordings_dialog(); },
    a: on_chosen('activate', 'Activate'), d: on_chosen('deactivate', 'Deactivate'), e: on_chosen('reset', 'Reset'),
    c: () => document.getElementById('connect')?.click(), Delete: delete_selected, Escape: () => select(null),
  };
  panel_names.forEach(([panel], i) => { table[String(i + 1)] = () => { show_only(panel); show_panel(panel, !dock.is_front(panel)); }; });
  // Space on a button presses it.
  if (event.key === ' ' && target.matches('button,[role=treeitem],summary')) return;
  const work = table[event.key];
  if (!work) return;
  work();
  event.preventDefault();
});

// ---- the link ----

const write_link = once_a_frame(() => {
  const { panels, layout, tab, plots, lasers, sonars, names, trails, collisions, contacts, frames } = settings;
  const link = to_link({ settings: { panels, layout, tab, plots, lasers, sonars, names, trails, collisions, contacts, frames }, eye: world.eye.state(), selection: store.selection, moment: recording() ? playback.moment : undefined });
  history.replaceState(null, '', link);
});
let link_timer = 0;
setInterval(() => {
  if (Date.now() - link_timer < 900) return;
  link_timer = Date.now();
  write_link();
}, 1000);

on(['status', 'world', 'system', 'states', 'hello'], once_a_frame(show_head));
on(['settings', 'world'], once_a_frame(show_tools));
on('settings', lay_out);
on('selection', () => {
  if (store.selection?.kind === 'component') diagram.reveal(store.selection.id);
});

apply_theme();
document.body.append(run_summary(playback, copy, plot), page, profile_input);
lay_out();
show_only('world');
changed('acts');
show_head();
if (linked.eye) world.restore(linked.eye);
if (linked.selection) select(linked.selection);
if (typeof linked.moment === 'number') playback.moment = linked.moment;
wire.connect();

// For tests, and for whoever looks with the browser's console.
Object.assign(window, { studio: { dock, world, diagram, store, wire, settings, select, act, playback, bottom, shell_word, shell_line } });
