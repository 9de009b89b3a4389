// SPDX-License-Identifier: MIT
'use strict';
// Usage: page_test.cjs BROWSER FILE TOKEN page|map|twins|again [FOLDER FOR SCREENSHOTS]
//   FILE will hold the page's address; FILE.wanted is made when the browser is there to look at it
//   map: of a run with a map that lasts, whose first session is `<i>monday`
//   twins: of a run whose places all look alike
//   after: of a run that is ended by SIGTERM when the page has made FILE.again, and begun anew likewise
//   again: of a run that is killed when the page has made FILE.again, and begun anew at its address with a drive that
//   is called `later` and begins later
const fs = require('node:fs');
const {assert, open, noSeriousFaults, noSidewaysScroll, start} = require('./browser.cjs');

const SIZES = [[390, 844], [800, 900], [1280, 800], [2560, 1300]];

async function picturesAreThere(page, selector) {
  await page.waitForFunction((where) => {
    const images = [...document.querySelectorAll(where + ' img')];
    return images.length > 0 && images.every((image) => image.complete && image.naturalWidth > 0);
  }, selector, {timeout: 60000});
}

/// Sessions as bands, what is saved, and saving at once.
async function showsTheMap(page) {
  const label = await page.getAttribute('#places', 'aria-label');
  assert.ok(label.endsWith('; sessions <i>monday, tuesday'), label);
  const bands = await page.evaluate(() => bandsOf(view.status.run.sessions, view.status.map.places));
  assert.deepStrictEqual([bands[0].first, bands[0].end, bands[1].first], [0, 200, 200]);
  const {places, frames} = await page.evaluate(() => ({places: view.status.map.places, frames: view.status.counts.frames}));
  assert.strictEqual(bands[1].end, places);
  assert.ok((await page.textContent('#map')).includes('2, the newest tuesday'));
  assert.ok((await page.textContent('#sentence')).match(/\(<i>monday\)|new|Waiting/), await page.textContent('#sentence'));
  await page.click('#save');
  // While the run is paused, no frame tells of it.
  await page.waitForFunction((least) => view.status.map.saved >= least, frames, {timeout: 60000});
  assert.ok((await page.textContent('#source')).endsWith(' in m.seqloop'));
}

/// Where two places look alike, both are seen.
async function showsTwins(page, folder) {
  await page.waitForFunction(() => document.querySelectorAll('#pair.three > figure').length === 3, null, {timeout: 120000});
  await page.click('#pause');
  await page.waitForFunction(() => view.status.state === 'paused', null, {timeout: 60000});
  const sentence = await page.textContent('#sentence');
  assert.match(sentence, /^No answer: two places look alike, see them: frame [\d,]+ looks like place [\d,]+ and like place [\d,]+\.$/);
  await picturesAreThere(page, '#pair');
  const {frame, place, runner_up: other} = await page.evaluate(() => view.status.shown);
  assert.notStrictEqual(place, other);
  const captions = await page.$$eval('#pair > figure > figcaption', (all) => all.map((one) => one.textContent));
  assert.deepStrictEqual(captions, [`frame ${frame}`, `place ${place}`, `or place ${other}`]);
  for (const [width, height] of SIZES) {
    await page.setViewportSize({width, height});
    await page.waitForTimeout(200);
    await noSidewaysScroll(page, `${width} pixels`);
    await noSeriousFaults(page, `${width} pixels`);
    if (folder) await page.screenshot({path: `${folder}/twins_${width}.png`, fullPage: true});
  }
}

/// Of a run that was killed nothing stays when another one is at its address, whose loops have the same numbers.
async function comesBack(page, url, file, token) {
  const wanted = {timeout: 120000};
  await page.waitForFunction(() => view.status && view.status.loops.listed >= 30 && view.dots.length > 0, null, wanted);
  await page.click('#pause');
  await page.waitForFunction(() => view.status.state === 'paused' && list.count === view.status.loops.listed &&
    Number(document.querySelector('#loops li')?.dataset.loop) === list.count - 1, null, wanted);
  const before = await page.evaluate(() => { pick(view.dots[0]); return list.count; });
  await page.context().setOffline(true);
  fs.writeFileSync(file + '.again', '');
  // What the other run says, as far as it can be reached.
  const status = () => fetch(url + '/api/status').then((reply) => reply.json()).catch(() => null);
  for (let now = null; !now || !now.run.source.endsWith('later') || now.loops.listed < before; now = await status()) {
    await new Promise((done) => setTimeout(done, 20));
  }
  const paused = await fetch(url + '/api/control', {method: 'POST', body: '{"do": "pause"}',
    headers: {'Content-Type': 'application/json', 'Authorization': 'Bearer ' + token}});
  assert.strictEqual(paused.status, 200);
  await page.context().setOffline(false);
  await page.waitForFunction(() => view.status && view.status.run.source.endsWith('later') &&
    list.count === view.status.loops.listed &&
    Number(document.querySelector('#loops li')?.dataset.loop) === list.count - 1, null, wanted);
  const {loops} = await page.evaluate(() => ask(`/api/loops?first=${list.count - 12}&count=12`));
  const texts = await page.$$eval('#loops li > p:first-of-type', (all) => all.map((one) => one.textContent));
  assert.deepStrictEqual(texts.map((text) => text.match(/frame \d+ is place \d+/)[0]),
    loops.reverse().map((loop) => `frame ${loop.frame} is place ${loop.match}`));
  assert.deepStrictEqual(await page.evaluate(() => [view.picked, byId('picked').hidden]), [null, true]);
  await page.locator('#loops li').first().getByRole('button', {name: /^accept/}).click();
  await page.waitForSelector('#loops li.accepted');
}

/// A run that was asked to end, as a service's restart does, is followed by the next one at its address.
async function followsTheNext(page, file) {
  const wanted = {timeout: 120000};
  await page.waitForFunction(() => view.status && view.status.counts.frames >= 10, null, wanted);
  fs.writeFileSync(file + '.again', '');
  await page.waitForFunction(() => byId('health').textContent === 'The run has ended.', null, wanted);
  // It stays so, until there is another one.
  await page.waitForTimeout(3000);
  assert.strictEqual(await page.textContent('#health'), 'The run has ended.');
  fs.writeFileSync(file + '.next', '');
  await page.waitForFunction(() => view.status && view.status.run.source.endsWith('later') &&
    view.status.counts.frames >= 10 && byId('health').textContent === 'running well', null, wanted);
}

async function stops(page, browser) {
  assert.deepStrictEqual(page.complaints(), []);
  page.on('dialog', (dialog) => dialog.accept());
  await page.click('#stop');
  await page.waitForFunction(() => document.getElementById('health').textContent.includes('ended'), null, {timeout: 60000});
  await browser.close();
}

async function addressIn(file) {
  fs.writeFileSync(file + '.wanted', '');
  while (!fs.existsSync(file)) await new Promise((done) => setTimeout(done, 50));
  return fs.readFileSync(file, 'utf8').trim();
}

async function main([path, file, token, mode, folder]) {
  const browser = await start(path);
  const page = await open(browser, {viewport: {width: 1280, height: 800}, colorScheme: 'light'});
  const url = await addressIn(file);
  // Refused once, as where too many look, the page asks again.
  await page.route('**/api/events', (route) => route.fulfill({status: 503}), {times: 1});
  await page.goto(`${url}/#token=${token}`);
  assert.strictEqual(await page.evaluate(() => location.hash), '', 'the token is in no address any more');
  if (mode === 'twins') {
    await showsTwins(page, folder);
    return stops(page, browser);
  }
  if (mode === 'after') {
    await followsTheNext(page, file);
    return stops(page, browser);
  }
  if (mode === 'again') {
    await comesBack(page, url, file, token);
    return stops(page, browser);
  }
  await page.waitForFunction(() => view.status && view.status.counts.frames >= 100, null, {timeout: 120000});
  // Names are text, whatever they hold.
  await page.waitForFunction(() => document.getElementById('source').textContent.includes('<b>query'));
  await page.waitForFunction(() => view.dots.length > 20, null, {timeout: 120000});
  await page.route('**/api/control', (route) => route.abort(), {times: 1});
  await page.click('#pause');
  await page.waitForFunction(() => byId('said').textContent === 'Not done: the robot is out of reach.');
  await page.click('#pause');
  await page.waitForFunction(() => view.status.state === 'paused' && view.status.shown.loops === view.status.loops.listed,
    null, {timeout: 60000});

  // A click on a dot shows its pair.
  const dot = await page.evaluate(() => {
    const {left, top, answer} = view.dots[Math.floor(view.dots.length / 2)];
    return {left, top, frame: answer.frame, match: answer.match};
  });
  await page.click('#places', {position: {x: dot.left, y: dot.top}});
  const picked = await page.textContent('#places-picked');
  const shown = await page.evaluate(() => [view.picked.frame, view.picked.match]);
  assert.ok(Math.abs(shown[0] - dot.frame) <= 3, 'the dot that was clicked, or one on top of it');
  assert.ok(picked.startsWith(`Frame ${shown[0]} is place ${shown[1]}` + (mode === 'map' ? ' (<i>monday)' : '')), picked);
  await picturesAreThere(page, '#picked');
  const sources = await page.$$eval('#picked > figure > img', (all) => all.map((image) => image.src));
  assert.deepStrictEqual(sources.map((at) => new URL(at).search),
    [`?of=frame&number=${shown[0]}`, `?of=place&number=${shown[1]}`]);
  await page.focus('#places');
  await page.keyboard.press('ArrowRight');
  assert.notStrictEqual(await page.textContent('#places-picked'), picked, 'the keyboard goes on to the next');

  if (mode === 'map') await showsTheMap(page);
  // Each name has its help text, without a mouse too.
  await page.click('summary');
  const helped = await page.$$eval('#words dt', (all) => all.map((term) => term.textContent));
  const named = await page.$$eval('#counts dt, #map dt', (all) => all.map((term) => term.textContent));
  const counted = await page.evaluate(() => {
    fillTerms('counts', [['match', '1'], ['warming_up', '2'], ['lost', '3']]);
    fillTerms('counts', [['match', '1'], ['unsure', '4'], ['lost', '3']]);
    return [...byId('counts').children].map((element) => element.textContent);
  });
  assert.deepStrictEqual(counted, ['match', '1', 'unsure', '4', 'lost', '3'], 'each value beside its own name');

  const said = await page.evaluate(() => Object.keys({...view.status.frame, ...view.status.answer, ...view.status.frame.latency_ms}));
  assert.ok(said.length > 20, String(said));
  assert.deepStrictEqual([...named, ...said].filter((name) => !helped.includes(name)), []);
  await page.click('summary');

  // A person's word on a loop is kept.
  const loop = page.locator('#loops li').first();
  const which = await loop.getAttribute('data-loop');
  await loop.getByRole('button', {name: /^reject/}).click();
  await page.waitForSelector(`#loops li.rejected[data-loop="${which}"]`);
  // Loops that did not come are asked for again, while none is added.
  await page.route('**/api/loops*', (route) => route.abort(), {times: 1});
  await page.reload();
  await page.waitForSelector(`#loops li.rejected[data-loop="${which}"]`);

  // Who has no token may look, and nothing else.
  const guest = await open(browser, {viewport: {width: 1280, height: 800}});
  await guest.goto(url);
  await guest.waitForSelector(`#loops li.rejected[data-loop="${which}"]`);
  assert.ok(!await guest.isVisible('#control'));
  assert.strictEqual(await guest.locator('#loops button').count(), 0);
  const refused = await guest.evaluate(() => fetch('/api/control', {method: 'POST', body: '{"do":"stop"}',
    headers: {'Content-Type': 'application/json'}}).then((reply) => reply.status));
  assert.strictEqual(refused, 401);
  await guest.close();

  await picturesAreThere(page, '#pair');
  const papers = new Set();
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({colorScheme});
    papers.add(await page.evaluate(() => getComputedStyle(document.body).backgroundColor));
    for (const [width, height] of SIZES) {
      await page.setViewportSize({width, height});
      await page.waitForTimeout(200);
      await noSidewaysScroll(page, `${width} pixels, ${colorScheme}`);
      await noSeriousFaults(page, `${width} pixels, ${colorScheme}`);
      if (folder) await page.screenshot({path: `${folder}/${mode}_${colorScheme}_${width}.png`, fullPage: true});
    }
  }
  assert.strictEqual(papers.size, 2, 'dark is another colour');
  await stops(page, browser);
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error);
  process.exit(1);
});
