// SPDX-License-Identifier: MIT
'use strict';
// Usage: report_test.cjs BROWSER PAGE.html [FOLDER FOR SCREENSHOTS]
const {assert, open, noSeriousFaults, noSidewaysScroll, start} = require('./browser.cjs');

async function main([path, file, folder]) {
  const browser = await start(path);
  for (const [width, colorScheme] of [[390, 'dark'], [1280, 'light']]) {
    const page = await open(browser, {viewport: {width, height: 800}, colorScheme, offline: true});
    await page.goto('file://' + file);
    await page.waitForFunction(() => view.dots.length > 20);
    await page.waitForFunction(() => document.getElementById('source').textContent.includes('<b>query'));
    assert.ok((await page.locator('#loops li').count()) > 0);
    const values = await page.$$eval('#counts dd, #map dd', (all) => all.map((one) => one.textContent));
    assert.ok(values.length > 10 && !values.includes('–'), `what lines do not tell has no row: ${values}`);
    const {left, top} = await page.evaluate(() => view.dots[0]);
    await page.click('#places', {position: {x: left, y: top}});
    const picked = await page.textContent('#places-picked');
    assert.ok(picked.startsWith('Frame '));
    const said = picked.includes('probability');
    assert.strictEqual(await page.isVisible('#probability'), said, 'an empty chart would say that nothing is sure');
    assert.strictEqual((await page.textContent('#probability-text')).includes('by uniqueness'), !said);
    await noSidewaysScroll(page, `report, ${width} pixels`);
    await noSeriousFaults(page, `report, ${width} pixels`);
    if (folder) await page.screenshot({path: `${folder}/report_${colorScheme}_${width}.png`, fullPage: true});
    assert.deepStrictEqual(page.complaints(), []);
    await page.close();
  }
  await browser.close();
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error);
  process.exit(1);
});
