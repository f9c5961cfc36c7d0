// Dialogs: the browser's own, which hold the focus and close on Escape.
import { button, h } from './dom';

export function open_dialog(title: string, body: HTMLElement, does: string, act?: () => void): HTMLDialogElement {
  const dialog = h('dialog', { 'aria-label': title });
  // At once: the browser tells of the end only after its next picture.
  const end = (event?: Event) => {
    event?.preventDefault();
    dialog.close();
    dialog.remove();
  };
  const form = h('form', { onsubmit: (event: Event) => { end(event); act?.(); } },
    h('header', null, h('h2', null, title), button('Close', { icon: 'close', class: 'plain' }, () => end())),
    body,
    h('footer', null, act ? button('Cancel', { label: 'Cancel' }, () => end()) : null, h('button', { type: 'submit', class: 'main' }, does)));
  dialog.append(form);
  dialog.addEventListener('cancel', end);
  dialog.addEventListener('keydown', (event) => event.stopPropagation());
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}

export function ask_text(title: string, label: string, value: string, does: string, act: (text: string) => void, hints: string[] = []): void {
  const input = h('input', { id: 'ask-text', value, list: 'ask-hints', autocomplete: 'off', autofocus: true });
  const body = h('div', { class: 'grid' }, h('label', { for: 'ask-text' }, label), input, h('datalist', { id: 'ask-hints' }, hints.map((hint) => h('option', { value: hint }))));
  open_dialog(title, body, does, () => { if (input.value.trim() !== '') act(input.value.trim()); });
}
