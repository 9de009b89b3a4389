// SPDX-License-Identifier: MIT
'use strict';
// Usage: readme_pictures.cjs BROWSER ADDRESS FOLDER
const {open, start} = require('./browser.cjs');

const VIEWS = [['page_light', 1280, 1500, 'light'], ['page_phone', 390, 1030, 'dark'], ['wide_dark', 2560, 1300, 'dark'],
  ['phone_light', 390, 844, 'light'], ['dark', 1280, 900, 'dark'], ['wide_light', 2560, 1300, 'light']];

async function main([path, url, folder]) {
  const browser = await start(path);
  for (const [name, width, height, colorScheme] of VIEWS) {
    const page = await open(browser, {viewport: {width, height}, colorScheme});
    await page.goto(url);
    await page.waitForFunction(() => view.dots.length > 100 &&
      [...document.images].every((image) => image.complete && image.naturalWidth > 0), null, {timeout: 120000});
    await page.screenshot({path: `${folder}/${name}.png`});
    await page.close();
  }
  await browser.close();
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error);
  process.exit(1);
});
