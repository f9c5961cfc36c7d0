// Flows that are told to end do, and leave nothing: no process, no shared memory, no file. end_flows.mjs BIN_DIR SOURCE_DIR LIB_DIR
import { spawn } from 'node:child_process';
import { randomUUID } from 'node:crypto';
import { mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, same, until } from './rig.mjs';

// All that it starts inherits this.
const mark = `STUDIO_MARK=${randomUUID()}`;
const work = mkdtempSync(join(tmpdir(), 'studio-end-'));

function marked() {
  return readdirSync('/proc').filter((name) => /^\d+$/.test(name)).filter((id) => {
    try {
      return readFileSync(`/proc/${id}/environ`, 'latin1').includes(mark) && !/^State:\s+Z/m.test(readFileSync(`/proc/${id}/status`, 'latin1'));
    } catch {
      return false;  // it has ended meanwhile
    }
  });
}

const name = (id) => { try { return readFileSync(`/proc/${id}/cmdline`, 'latin1').split('\0')[0]; } catch { return id; } };

async function end_by(signal, status) {
  const [key, value] = mark.split('=');
  const child = spawn(process.execPath, [join(dirname(fileURLToPath(import.meta.url)), 'system_flows.mjs'), ...process.argv.slice(2)], { env: { ...process.env, [key]: value, TMPDIR: work }, stdio: ['ignore', 'pipe', 'inherit'] });
  for (const told of ['SIGTERM', 'SIGINT', 'SIGHUP']) process.once(told, () => child.kill(told)); // and then the check of its status ends this
  let said = '';
  child.stdout.on('data', (text) => { said += text; });
  const ended = new Promise((resolve) => child.once('close', resolve));
  await until('a flow or the end', () => said.includes('\nok ') || said.startsWith('ok ') || child.exitCode !== null);
  if (child.exitCode === 77) {
    console.log('skipped: no chromium-headless-shell (scripts/setup installs it)');
    process.exit(77);
  }
  check(marked().length > 3, 'a system runs');
  child.kill(signal);
  same(await ended, status, `status after ${signal}`);
  const left = await until('all have ended', () => { const ids = marked(); return ids.length === 0 ? [] : null; }, 10000).catch(() => marked().map(name));
  same(left, [], 'processes that are left');
  same(readdirSync(work), [], 'files that are left');
}

try {
  await end_by('SIGTERM', 143);
  await end_by('SIGINT', 130);
  console.log('all is well');
} finally {
  rmSync(work, { recursive: true, force: true });
}
