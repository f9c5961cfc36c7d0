// Text as words of a shell's command line, as base/shell_word.h has it: what is copied from here and pasted into a terminal contains printable
// ASCII only, so no name is obeyed by the terminal.
const plain = /^[A-Za-z0-9._\-/:,+@][A-Za-z0-9._\-/:=,+@%]*$/;

export function shell_word(text: string): string {
  if (plain.test(text)) return text;
  if (/^[ -~]*$/.test(text)) return `'${text.replaceAll("'", "'\\''")}'`;
  const hex = (octet: number) => `\\x${octet.toString(16).padStart(2, '0')}`;
  const escaped = [...new TextEncoder().encode(text)].map((octet) => {
    const letter = String.fromCharCode(octet);
    if (octet === 0) return ''; // which no word can hold
    if (letter === "'" || letter === '\\') return `\\${letter}`;
    return octet < 0x20 || octet > 0x7e || letter === '!' ? hex(octet) : letter;
  });
  return `$'${escaped.join('')}'`;
}

export const shell_line = (words: string[]): string => words.map(shell_word).join(' ');

// What may be copied: whatever it is of, a terminal obeys none of it.
export const is_pasteable = (text: string): boolean => /^[ -~]*$/.test(text);
