// Lock files of npm: exact versions with their hashes and no address of a registry, so that any registry will do. locks.mjs SOURCE_DIR
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

const source = process.argv[2];
let failed = 0;
const complain = (text) => {
  failed += 1;
  console.log(text);
};

for (const folder of ['tools/studio/web', 'tests/studio', 'tests/foreign']) {
  const wanted = JSON.parse(readFileSync(join(source, folder, 'package.json'), 'utf8'));
  const text = readFileSync(join(source, folder, 'package-lock.json'), 'utf8');
  const lock = JSON.parse(text);
  if (/https?:\/\/(?!(opencollective|github|www\.patreon|feross|paulmillr|tidelift)\b)[^"]*(registry|\.tgz)/.test(text)) complain(`${folder}: the lock file names an address`);
  for (const [name, entry] of Object.entries(lock.packages)) {
    if (name === '') continue;
    if (entry.resolved) complain(`${folder}: ${name} has an address`);
    if (!entry.integrity) complain(`${folder}: ${name} has no hash`);
    if (!/^\d+\.\d+\.\d+/.test(entry.version)) complain(`${folder}: ${name} has no exact version`);
  }
  for (const [name, version] of Object.entries({ ...wanted.dependencies, ...wanted.devDependencies })) {
    if (!/^\d/.test(version)) complain(`${folder}: ${name} ${version} is not exact`);
    if (lock.packages[`node_modules/${name}`]?.version !== version) complain(`${folder}: ${name} ${version} is not what is locked`);
  }
}
console.log(failed === 0 ? 'ok' : `${failed} found`);
process.exit(failed === 0 ? 0 : 1);
