// SPDX-License-Identifier: MIT
// Canvases: places over frames, probability, times. Each is drawn anew when there is news.

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();

/// A canvas as large as it is shown, in its device's pixels. Returns its context and size.
function sized(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const {width, height} = canvas.getBoundingClientRect();
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = '12px system-ui, sans-serif';
  context.lineWidth = 1;
  return {context, width, height};
}

const MARGIN = {left: 52, right: 10, top: 8, bottom: 22};

/// Round steps for about this many lines.
function ticks(most, wanted) {
  if (!(most > 0)) return [0];
  const rough = most / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((one) => one * power >= rough) * power;
  const all = [];
  for (let at = 0; at <= most * 1.0001; at += step) all.push(at);
  return all;
}

/// Axes from `x0` to `x1` and 0 to `y1`; returns how values become pixels.
function axes({context, width, height}, x0, x1, y1, words) {
  const inner = {w: width - MARGIN.left - MARGIN.right, h: height - MARGIN.top - MARGIN.bottom};
  const x = (value) => MARGIN.left + (value - x0) / Math.max(x1 - x0, 1e-9) * inner.w;
  const y = (value) => MARGIN.top + inner.h - value / Math.max(y1, 1e-9) * inner.h;
  context.strokeStyle = colour('line');
  context.fillStyle = colour('soft');
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const at of ticks(y1, 4)) {
    context.beginPath();
    context.moveTo(MARGIN.left, y(at));
    context.lineTo(width - MARGIN.right, y(at));
    context.stroke();
    context.fillText(at.toLocaleString('en'), MARGIN.left - 6, y(at));
  }
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (const at of words ? ticks(x1 - x0, width < 500 ? 3 : 6) : []) {
    if (x(at + x0) < width - 12 - context.measureText(words).width) context.fillText(Math.round(at + x0).toLocaleString('en'), x(at + x0), height - MARGIN.bottom + 5);
  }
  context.textAlign = 'right';
  context.fillText(words, width - MARGIN.right, height - MARGIN.bottom + 5);
  return {x, y};
}

/// Sessions of the map as bands, every second one shaded.
function drawSessions({context, width}, sessions, most, y) {
  const right = width - MARGIN.right;
  sessions.forEach(({name, first}, i) => {
    const next = i + 1 < sessions.length ? sessions[i + 1].first : most;
    const [low, high] = [y(Math.min(first, most)), y(Math.min(next, most))];
    if (low - high < 1) return;
    context.globalAlpha = i % 2 ? .5 : .2;
    context.fillStyle = colour('line');
    context.fillRect(MARGIN.left, high, right - MARGIN.left, low - high);
    context.globalAlpha = 1;
    if (low - high < 16) return;
    context.fillStyle = colour('soft');
    context.textAlign = 'right';
    context.textBaseline = 'top';
    context.fillText(name, right - 4, high + 3, right - MARGIN.left - 8);
  });
}

/// Places over frames. Returns the dots for who points at them.
function drawPlaces(canvas, answers, ownPlaces, picked, marks, sessions) {
  const area = sized(canvas);
  const matches = answers.filter((one) => one.status === 'match' && one.match !== null);
  const last = answers.reduce((most, one) => Math.max(most, one.frame), 1);
  const most = matches.reduce((far, one) => Math.max(far, one.match), ownPlaces ? last : 1);
  const {x, y} = axes(area, 0, last, most, 'frame');
  const {context} = area;
  drawSessions(area, sessions, most, y);
  if (ownPlaces) {  // the drive itself: no match lies above this line
    context.strokeStyle = colour('soft');
    context.setLineDash([4, 4]);
    context.beginPath();
    context.moveTo(x(0), y(0));
    context.lineTo(x(last), y(last));
    context.stroke();
    context.setLineDash([]);
  }
  context.fillStyle = colour('grab');
  for (const one of answers) {
    if (one.status === 'unsure' && one.match !== null) context.fillRect(x(one.frame) - 1, y(one.match) - 1, 2, 2);
  }
  const dots = matches.map((one) => ({left: x(one.frame), top: y(one.match), answer: one}));
  context.fillStyle = colour('accent');
  for (const dot of dots) {
    context.beginPath();
    context.arc(dot.left, dot.top, 2.5, 0, 7);
    context.fill();
  }
  context.fillStyle = colour('warn');
  for (const mark of marks) {
    context.textAlign = 'center';
    context.fillText('▲ ' + mark.name, x(mark.frame), area.height - MARGIN.bottom - 14);
  }
  const dot = picked && dots.find((one) => one.answer.serial === picked.serial);
  if (dot) {
    context.strokeStyle = colour('bad');
    context.lineWidth = 2;
    context.beginPath();
    context.arc(dot.left, dot.top, 7, 0, 7);
    context.stroke();
  }
  canvas.setAttribute('aria-label', `Places over frames: ${matches.length} matches in ${last} frames`);
  return dots;
}

function drawProbability(canvas, answers, least) {
  const area = sized(canvas);
  const shown = answers.slice(-1500);
  const {x, y} = axes(area, shown.length ? shown[0].frame : 0, shown.length ? shown[shown.length - 1].frame : 1, 1, 'frame');
  const {context} = area;
  for (const [status, name] of [[false, 'soft'], [true, 'accent']]) {
    context.fillStyle = colour(name);
    for (const one of shown) {
      if (one.probability !== null && (one.status === 'match') === status)
        context.fillRect(x(one.frame) - 1, y(one.probability) - 1.5, 3, 3);
    }
  }
  if (least) {
    context.strokeStyle = colour('bad');
    context.setLineDash([4, 3]);
    context.beginPath();
    context.moveTo(MARGIN.left, y(least));
    context.lineTo(area.width - MARGIN.right, y(least));
    context.stroke();
    context.setLineDash([]);
  }
}

/// Bars of the newest frames, grab, describe and match upon each other.
function drawTimes(canvas, frames, budget) {
  const area = sized(canvas);
  const most = frames.reduce((far, one) => Math.max(far, one[4]), 0);
  // The budget is shown where it is near; otherwise the bars would be too small to be seen.
  const near = budget && budget < 4 * most;
  const top = Math.max(most, near ? budget * 1.1 : 0, 1e-3);
  const {x, y} = axes(area, 0, 300, top, '');
  const {context} = area;
  const step = (x(300) - x(0)) / 300;
  frames.forEach((one, i) => {
    const at = x(300 - frames.length + i);
    let base = 0;
    for (const [stage, name] of [[1, 'grab'], [2, 'describe'], [3, 'match']]) {
      context.fillStyle = colour(name);
      context.fillRect(at, y(base + one[stage]), Math.max(step - .4, 1), y(base) - y(base + one[stage]));
      base += one[stage];
    }
  });
  if (near) {
    context.strokeStyle = colour('bad');
    context.setLineDash([4, 3]);
    context.beginPath();
    context.moveTo(MARGIN.left, y(budget));
    context.lineTo(area.width - MARGIN.right, y(budget));
    context.stroke();
    context.setLineDash([]);
  }
}
