// SPDX-License-Identifier: MIT
'use strict';
// What both tests of the page need.
const assert = require('node:assert');
const fs = require('node:fs');
const {chromium} = require('playwright-core');

/// A page of its own, that fails the test on whatever its script or the browser complains of.
async function open(browser, options) {
  const page = await (await browser.newContext(options)).newPage();
  const complaints = [];
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => { if (message.type() === 'error') complaints.push(message.text()); });
  // A picture that came too late, and the stream when the run ends, are no faults of the page.
  page.complaints = () => complaints.filter((text) => !/Failed to load resource|net::ERR/.test(text));
  return page;
}

async function noSeriousFaults(page, what) {
  await page.evaluate(fs.readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8'));
  const {violations} = await page.evaluate(() => axe.run());
  const serious = violations.filter((one) => ['serious', 'critical'].includes(one.impact));
  assert.deepStrictEqual(serious.map((one) => `${one.id}: ${one.nodes.map((node) => node.html).join(' | ')}`), [], what);
}

const noSidewaysScroll = async (page, what) =>
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), `${what} scrolls sideways`);

const start = (executablePath) => chromium.launch({executablePath, args: ['--no-sandbox', '--disable-gpu']});

module.exports = {assert, open, noSeriousFaults, noSidewaysScroll, start};
