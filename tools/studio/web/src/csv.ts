// Rows of comma-separated values, as RFC 4180 has them.
export function parse_csv(text: string): string[][] {
  const rows: string[][] = [];
  let row: string[] = [], field = '', is_quoted = false;
  for (let i = 0; i < text.length; ++i) {
    const c = text[i];
    if (is_quoted) {
      if (c !== '"') field += c;
      else if (text[i + 1] === '"') field += text[++i];
      else is_quoted = false;
    } else if (c === '"') is_quoted = true;
    else if (c === ',' || c === '\n') {
      row.push(field);
      field = '';
      if (c === '\n') {
        rows.push(row);
        row = [];
      }
    } else if (c !== '\r') field += c;
  }
  if (field !== '' || row.length > 0) rows.push([...row, field]);
  return rows;
}
