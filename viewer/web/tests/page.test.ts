import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Vector3} from 'three';
import {splitEvents, splitToken, unpack} from '../src/api';
import {addPoint, clipped, clippedPath, firstCurves, growable, PRESETS, removePoint} from '../src/curves/state';
import {say} from '../src/dom';
import {History} from '../src/history';
import {turned} from '../src/keys';
import {firstPatches, handleName, handles, movePoint, PATCH_PRESETS, pointsOf, readDocument, robustRange, snapped, type PatchDocument} from '../src/patches/state';
import {rampBytes, rampColour} from '../src/ramps';
import {decoded, encoded, merged} from '../src/state';
import {planDrawing, planPath} from '../src/terrain/plan';
import {ticks} from '../src/terrain/profile';
import {coarseToFine, setTerm, termsOf, TETRA_PRESETS} from '../src/tetraquads/state';
import {cellCentre, fitRequest, firstLook, roundStep, SIDE_BY_SIDE, type FileInfo} from '../src/terrain/state';

test('events are split, and what is incomplete waits', () => {
  const whole = 'event: progress\ndata: {"a":1}\n\nevent: done\ndata: {"b":2}\n\n';
  for (let cut = 0; cut <= whole.length; ++cut) {
    const first = splitEvents(whole.slice(0, cut));
    const second = splitEvents(first.rest + whole.slice(cut));
    assert.deepEqual([...first.events, ...second.events], [['progress', '{"a":1}'], ['done', '{"b":2}']]);
    assert.equal(second.rest, '');
  }
});

test('the token is taken out of the fragment, and what else stands there stays', () => {
  assert.deepEqual(splitToken('#token=aB-_9'), {token: 'aB-_9', rest: ''});
  assert.deepEqual(splitToken('#view=xyz&token=abc'), {token: 'abc', rest: 'view=xyz'});
  assert.deepEqual(splitToken('#view=xyz'), {token: '', rest: 'view=xyz'});
  assert.deepEqual(splitToken(''), {token: '', rest: ''});
});

test('binary answers: arrays start at multiples of 8, whatever the header is long', () => {
  for (let pad = 0; pad < 9; ++pad) {
    const header = JSON.stringify({words: {pad: 'x'.repeat(pad)}, arrays: [{name: 'a', type: 'f64', offset: 0, count: 2}, {name: 'b', type: 'u8', offset: 16, count: 3}]});
    const start = Math.ceil((8 + header.length) / 8) * 8;
    const buffer = new ArrayBuffer(start + 24), bytes = new Uint8Array(buffer);
    bytes.set(new TextEncoder().encode('RTL1'));
    new DataView(buffer).setUint32(4, header.length, true);
    bytes.set(new TextEncoder().encode(header), 8);
    new Float64Array(buffer, start, 2).set([1.25, -3]);
    bytes.set([7, 8, 9], start + 16);
    const {words, arrays} = unpack(buffer);
    assert.equal((words.pad as string).length, pad);
    assert.deepEqual([...arrays.a], [1.25, -3]);
    assert.deepEqual([...arrays.b], [7, 8, 9]);
  }
  assert.throws(() => unpack(new ArrayBuffer(16)), /damaged/);
});

test('undo and redo walk through the changes; a slider is one step', () => {
  let time = 0;
  const history = new History({a: 0, tool: 'x'}, () => time);
  for (let k = 1; k <= 5; ++k) {
    time += 100;
    history.change((s) => { s.a = k; }, {group: 'slider'});
  }
  time += 5000;
  history.change((s) => { s.a = 9; }, {group: 'slider'});
  history.change((s) => { s.tool = 'y'; }, {silent: true});
  history.change((s) => { s.a = 9; });  // no change: no step
  history.undo();
  assert.equal(history.state.a, 5);
  history.undo();
  assert.equal(history.state.a, 0);
  assert.equal(history.canUndo, false);
  history.undo();
  history.redo();
  assert.equal(history.state.a, 5);
  history.redo();
  assert.deepEqual(history.state, {a: 9, tool: 'y'});
  history.undo();
  history.change((s) => { s.a = 1; });
  assert.equal(history.canRedo, false);
});

test('numbers are said as people read them', () => {
  assert.equal(say(-1.5), '−1.5');
  assert.equal(say(NaN), 'no data');
  assert.equal(say(null), 'no data');
  assert.equal(say(1234567.891, 6), '1234568');
  assert.equal(say(0.1 + 0.2), '0.3');
  assert.equal(say(0.00001234), '1.234e−5');
});

test('a turn by keys keeps the distance, and neither stands on its head nor goes below the ground', () => {
  const way = new Vector3(0, -3, 4);
  const aside = turned(way, 1, 0, Math.PI);
  assert.ok(Math.abs(aside.length() - 5) < 1e-12 && Math.abs(aside.z - 4) < 1e-12 && aside.x > 0.2);
  let low = way, high = way;
  for (let k = 0; k < 60; ++k) [low, high] = [turned(low, 0, 1, Math.PI / 2), turned(high, 0, -1, Math.PI / 2)];
  assert.ok(Math.abs(low.z) < 1e-9 && Math.abs(low.length() - 5) < 1e-9);
  assert.ok(high.z < 5 && high.z > 4.99 && high.y < 0);
});

test('ramps keep their ends, and the difference ramp is white in the middle', () => {
  assert.deepEqual(rampColour('difference', 0), [33, 102, 172]);
  assert.deepEqual(rampColour('difference', 1), [178, 24, 43]);
  assert.deepEqual(rampColour('difference', 0.5), [247, 247, 247]);
  assert.deepEqual(rampColour('amount', NaN), [0, 32, 76]);
  assert.equal(rampBytes('heights').length, 1024);
});

test('the lightness of the ramps of amounts rises all the way: readable without colour', () => {
  for (const name of ['heights', 'amount'] as const) {
    let before = -1;
    for (let i = 0; i <= 64; ++i) {
      const [r, g, b] = rampColour(name, i / 64);
      const lightness = 0.2126 * r + 0.7152 * g + 0.0722 * b;
      assert.ok(lightness >= before, `${name} at ${i}`);
      before = lightness;
    }
  }
});

test('steps are 1, 2 or 5 times a power of ten', () => {
  for (const [value, step] of [[1, 1], [1.9, 1], [2, 2], [4.99, 2], [5, 5], [77, 50], [0.03, 0.02]]) assert.ok(Math.abs(roundStep(value) - step) < 1e-12 * step, String(value));
  assert.equal(roundStep(NaN), 1);
  assert.deepEqual(ticks(150, 420, 4), [200, 300, 400]);
});

test('a fit is asked for by its error or by its vertices, never both', () => {
  const info = {kind: 'grid', low: 100, high: 600, cell: 10, valid: 40000} as FileInfo;
  const state = firstLook(0, info);
  assert.deepEqual(fitRequest(state, SIDE_BY_SIDE[2], 100), {file: 0, surface: 'clough-tocher', fit: 'surface', max_error: 10, triangles: 100});
  state.budget = 'vertices';
  assert.deepEqual(fitRequest(state, SIDE_BY_SIDE[0], 100), {file: 0, surface: 'linear', fit: 'interpolate', vertices: 400, triangles: 100});
});

test('contours from above: pairs that follow each other are one line, north is up', () => {
  const segments = new Float32Array([0, 0, 5, 1, 0, 5, 1, 0, 5, 1, 1, 5, -1, -1, 5, -1, 1, 5]);
  assert.equal(planPath(segments, (x, y) => [x, -y]).replace(/-0\.00/g, '0.00'), 'M0.00 0.00L1.00 0.00L1.00 -1.00M-1.00 1.00L-1.00 -1.00');
  const drawing = planDrawing(segments, new Float32Array(), 4, 2, 'metre', 'a < b');
  assert.match(drawing, /^<svg xmlns="http:\/\/www.w3.org\/2000\/svg" width="1000" height="550"/);
  assert.match(drawing, /class="minor"[^>]*d="M500.00 260.00L740.00 260.00L740.00 20.00M/);
  assert.match(drawing, />1 metre; a &lt; b</);
});

test('a click goes to the nearest cell, and stays in the grid', () => {
  const info = {cell_size: [10, 20], columns: 4, rows: 3} as unknown as FileInfo;
  assert.deepEqual(cellCentre([6, 9], info), [5, 0]);
  assert.deepEqual(cellCentre([-4, 11], info), [-5, 20]);
  assert.deepEqual(cellCentre([999, -999], info), [15, -20]);
  assert.deepEqual(cellCentre([1.5, 2.5], {} as FileInfo), [1.5, 2.5]);
});

test('lines are cut at the limit and nowhere else', () => {
  assert.deepEqual(clipped([0, 0], [1, 2], 10), [[0, 0], [1, 2]]);
  assert.deepEqual(clipped([-20, 0], [20, 0], 10), [[-10, 0], [10, 0]]);
  assert.equal(clipped([-20, 11], [20, 11], 10), null);
  assert.equal(clipped([0, 21], [21, 0], 10), null);
  assert.deepEqual(clipped([0, -40], [0, 5], 10), [[0, -10], [0, 5]]);
  assert.equal(clippedPath([[0, 0], [1, 0], [1, 1]], 10), 'M0.00 0.00L1.00 0.00L1.00 1.00');
  assert.equal(clippedPath([[0, 0], [20, 0], [0, 1]], 10), 'M0.00 0.00L10.00 0.00M10.00 0.50L0.00 1.00');
});

test('points are added and removed where the kind allows it', () => {
  const spec = {kind: 'bezier', points: [[0, 0], [1, 1]], weights: [1, 2]};
  assert.ok(growable(spec));
  addPoint(spec, [2, 0]);
  assert.deepEqual(spec.weights, [1, 2, 1]);
  assert.ok(removePoint(spec, 0));
  assert.deepEqual(spec, {kind: 'bezier', points: [[1, 1], [2, 0]], weights: [2, 1]});
  assert.equal(removePoint(spec, 0), false);  // a curve keeps two points
  assert.equal(growable({kind: 'bezier', degree: 3, points: []}), false);
  assert.equal(growable({kind: 'implicit', f: 'x'}), false);
  assert.ok(PRESETS.every(([, document]) => document.curves.length > 0));
});

test('a link holds the state, and wrong values in it are left out', () => {
  const state = {a: 1, name: 'Pão – 山', list: [1, 2], inner: {on: true}, maybe: null};
  const text = encoded(state);
  assert.match(text, /^[\w-]+$/);
  assert.deepEqual(merged({a: 0, name: '', list: [], inner: {on: false}, maybe: null}, decoded(text)), state);
  assert.deepEqual(merged({a: 0, inner: {on: false}}, {a: 'x', inner: 5, other: 1}), {a: 0, inner: {on: false}});
  const curves = firstCurves();
  assert.deepEqual(merged(curves, decoded(encoded(curves))), curves);
});

/** The ends of a patch's sides, as they run. */
function ends(document: PatchDocument, patch: number): [number[], number[]][] {
  return document.patches[patch].sides.map(({curve, reversed}) => {
    const points = pointsOf(document.curves[curve]), pair: [number[], number[]] = [points[0], points[points.length - 1]];
    return reversed ? [pair[1], pair[0]] : pair;
  });
}

test('a corner of a triangular surface moves in all of its curves, and the sides stay joined', () => {
  for (const [name, preset] of PATCH_PRESETS) {
    const document = structuredClone(preset), all = handles(document);
    const corners = all.filter(({corner}) => corner).length;
    assert.equal(corners, {Saddle: 3, 'Octant of a sphere': 3, Blade: 3, Hull: 5}[name], name);
    const inner = document.curves.reduce((n, curve) => n + pointsOf(curve).length - 2, 0);
    assert.equal(all.length, corners + inner, name);
    all.forEach(({handle}, k) => movePoint(document, handle, [k, 2 * k, k * k]));
    all.forEach(({handle: [curve, index]}, k) => assert.deepEqual(pointsOf(document.curves[curve])[index], [k, 2 * k, k * k]));
    document.patches.forEach((_, patch) => ends(document, patch).forEach(([, end], k, sides) => assert.deepEqual(end, sides[(k + 1) % 3][0], `${name}, patch ${patch}`)));
  }
});

test('documents of patches are read as the program reads them', () => {
  assert.deepEqual(PATCH_PRESETS.map(([name, {patches}]) => [name, patches.length]), [['Saddle', 1], ['Octant of a sphere', 1], ['Blade', 2], ['Hull', 4]]);
  const side = (...points: number[][]) => ({kind: 'bezier', points});
  const a = [0, 0, 0], b = [1, 0, 0], c = [0, 1, 0], d = [1, 1, 1];
  // Written out twice, once backwards: one curve, which both patches share.
  const {document} = readDocument({patches: [{sides: [side(a, b), side(b, c), side(c, a)]}, {name: 'second', sides: [side(c, b), {...side(d, b), reversed: true}, side(d, c)]}]});
  assert.equal(document.curves.length, 5);
  assert.deepEqual(document.patches[1], {name: 'second', sides: [{curve: 1, reversed: true}, {curve: 3, reversed: true}, {curve: 4, reversed: false}]});
  assert.deepEqual(readDocument(document).document, document, 'what the page saves is read back as it is');
  const three = readDocument({curves: [side(a, b), side(b, c), side(c, a)]});
  assert.deepEqual(three.document.patches[0].sides.map(({curve}) => curve), [0, 1, 2]);
  assert.equal(handleName(three.document, [1, 0]), 'Side 2, point 1');
  assert.equal(readDocument({patches: [{sides: [side(a, b), side(b, c), side(c, a)], divisions: [8, 9, 10]}]}).divisions, 8);
  for (const [wrong, words] of [[null, /expected/], [{curves: []}, /expected/], [{patches: [{sides: [1, 2]}]}, /patches\[0\].sides: expected three/], [{curves: [side(a, b)], patches: [{sides: ['keel', 0, 0]}]}, /names the curve "keel"/], [{patches: [{sides: [7, 7, 7]}]}, /names the curve 7/]] as const) assert.throws(() => readDocument(wrong), words);
  assert.deepEqual(pointsOf({kind: 'bezier', points: [[0, 0]] as never}), [], 'points of the plane are not dragged in space');
  assert.deepEqual(pointsOf({kind: 'power', points: [[0, 0, 0]]}), [], 'coefficients are no places');
  assert.deepEqual(snapped([0.123, -0.26, 7], 0.1), [0.1, -0.3, 7]);
  assert.deepEqual(snapped([0.123, -0.26, 7], 0), [0.123, -0.26, 7]);
  assert.equal(firstPatches().document.patches.length, 1);
});

test('a legend leaves out the wildest values and keeps 0 in the middle', () => {
  const values = Float32Array.from({length: 1000}, (_, k) => k / 1000 - 0.25);
  values[0] = -1e9;
  values[1] = NaN;
  const [low, high] = robustRange(values, true);
  assert.equal(low, -high);
  assert.ok(high > 0.6 && high < 0.76);
  assert.deepEqual(robustRange(new Float32Array(0), true), [0, 1]);
});

test('a vertex gets a quadric of its own when one of its terms is set, and the others stay', () => {
  const document = structuredClone(TETRA_PRESETS[0][1]);
  assert.deepEqual(termsOf(document, [1, 1, 0]), {xx: 1, yy: 1, zz: 1, '1': -0.3});
  setTerm(document, [1, 1, 0], 'xy', 0.5);
  setTerm(document, [1, 1, 0], 'xx', 2);
  assert.deepEqual(termsOf(document, [1, 1, 0]), {xx: 2, yy: 1, zz: 1, '1': -0.3, xy: 0.5});
  assert.deepEqual(termsOf(document, [0, 0, 0]), {xx: 1, yy: 1, zz: 1, '1': -0.3});
  assert.equal(document.quadrics?.length, 1);
});

test('a reconstruction goes from coarse to fine and ends where it was asked to', () => {
  for (let last = 8; last <= 48; ++last) {
    const steps = coarseToFine(last);
    assert.equal(steps.at(-1), last);
    for (let k = 1; k < steps.length; ++k) assert.ok(steps[k] > steps[k - 1]);
  }
  assert.deepEqual(coarseToFine(24), [8, 13, 20, 24]);
});
