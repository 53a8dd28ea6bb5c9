#!/usr/bin/env node
// Runs the statements of docs/queries.md with DuckDB on a campaign of three tests, and checks that
// types and nulls are those of the table.
//
// usage: queries.cjs PROGRAM docs/queries.md
// DuckDB is npm's @duckdb/node-api, where NODE_PATH, the working directory or npm's global folder has
// it; ends with 77 where it is not.
'use strict';
const {execFileSync, spawnSync} = require('child_process');
const {createRequire} = require('module');
const fs = require('fs');
const os = require('os');
const path = require('path');
const assert = require('assert');

function duckdb() {
  const npm = spawnSync('npm', ['root', '-g'], {encoding: 'utf8'});
  const folders = [process.cwd(), ...(npm.status === 0 ? [path.dirname(npm.stdout.trim())] : [])];
  for (const from of [require, ...folders.map(folder => createRequire(folder + '/'))]) {
    try {
      return from('@duckdb/node-api');
    } catch (error) {
      if (error.code !== 'MODULE_NOT_FOUND') throw error;
    }
  }
  console.log('skipped: @duckdb/node-api is not installed (npm install @duckdb/node-api)');
  process.exit(77);
}

// Cells of the program's own table; no cell of it has a comma but those in quotes.
function table(text) {
  const [header, ...lines] = text.trimEnd().split('\n');
  const names = header.split(',');
  return lines.map(line => {
    const cells = line.match(/("([^"]|"")*"|[^,]*)(,|$)/g).map(cell => cell.replace(/,$/, ''));
    return Object.fromEntries(names.map((name, k) => [name, cells[k]]));
  });
}

async function main() {
  const {DuckDBInstance} = duckdb();
  const program = path.resolve(process.argv[2]);
  const statements = [...fs.readFileSync(process.argv[3], 'utf8').matchAll(/```sql\n([^`]*)```/g)]
    .map(found => found[1]);
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'mindahl-queries-'));
  process.chdir(folder);
  for (const [name, force, cycles] of [['a', 50, 6], ['b', 60, 5], ['short', 55, 4]]) {
    execFileSync(program, ['simulate', '--sigma', '5e7', '--slip-force', force, '--amplitude',
      name === 'short' ? '1e-8' : '2.5e-6', '--cycles', cycles, '--noise-force', '0.3', '-o',
      `${name}.csv`]);
  }
  fs.copyFileSync('a.csv', 'copy.csv');
  const run = spawnSync(program, ['track', '--separate', 'a.csv', 'b.csv', 'short.csv', 'copy.csv',
    'absent.csv', '--output', 'campaign.csv'], {encoding: 'utf8'});
  assert.strictEqual(run.status, 3, run.stderr);
  const rows = table(fs.readFileSync('campaign.csv', 'utf8'));

  const connection = await (await DuckDBInstance.create(':memory:')).connect();
  const query = async sql => (await connection.runAndReadAll(sql)).getRowObjectsJson();
  const answers = [];
  for (const statement of statements) answers.push(await query(statement));

  // Every column of the table is in the view, in its order; what is empty is null, all else equal.
  const columns = await query('DESCRIBE cycles');
  assert.deepStrictEqual(columns.map(column => column.column_name), Object.keys(rows[0]));
  const types = Object.fromEntries(columns.map(column => [column.column_name, column.column_type]));
  assert.strictEqual(types.cycle, 'BIGINT');
  assert.strictEqual(types.normal_load, 'DOUBLE');
  const read = await query('SELECT * FROM cycles');
  assert.strictEqual(read.length, rows.length);
  read.forEach((row, k) => {
    for (const [name, cell] of Object.entries(rows[k])) {
      if (cell === '') {
        assert.strictEqual(row[name], null, `${name} of row ${k}`);
      } else if (types[name] === 'VARCHAR') {
        assert.strictEqual(row[name], cell.replace(/^"(.*)"$/, '$1').replaceAll('""', '"'));
      } else {
        assert.strictEqual(Number(row[name]), Number(cell), `${name} of row ${k}`);
      }
    }
  });
  // Without the types: no number is read as text, but in columns that are empty throughout.
  for (const column of await query("DESCRIBE SELECT * FROM read_csv('campaign.csv')")) {
    const cells = rows.map(row => row[column.column_name]).filter(cell => cell !== '');
    if (types[column.column_name] === 'VARCHAR' || cells.length === 0) continue;
    assert.notStrictEqual(column.column_type, 'VARCHAR', column.column_name);
  }

  const answer = text => answers[statements.findIndex(statement => statement.includes(text))];
  assert.deepStrictEqual(answer('SELECT test, fault').map(row => row.test), ['absent.csv']);
  assert.deepStrictEqual(answer('HAVING count(DISTINCT test) > 1')[0].tests.toSorted(),
    ['a.csv', 'copy.csv']);
  const forces = Object.fromEntries(answer('AS scatter').map(row => [row.test, row]));
  for (const [test, force] of [['a.csv', 50], ['b.csv', 60]]) {
    const kErrors = 5;  // standard errors of a cycle; of the mean of four they are ten
    const {slip_force: found, stated_error: error} = forces[test];
    assert.ok(Math.abs(found - force) < kErrors * error, `${test}: ${found} ± ${error}`);
  }
  const flagged = rows.filter(row => row.flags.split(' ').includes('slip_force_open')).length;
  const counted = answer('unnest').find(row => row.flag === 'slip_force_open');
  assert.ok(flagged > 0);
  assert.strictEqual(Number(counted.cycles), flagged);
  const parquet = await query("SELECT * FROM 'campaign.parquet'");
  assert.deepStrictEqual(parquet, read);
  console.log(`${statements.length} statements of the page on ${rows.length} rows`);
  process.chdir('/');
  fs.rmSync(folder, {recursive: true});
}

main().catch(error => {
  console.error(error);
  process.exit(1);
});
