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
    const text = Math.round(at + x0).toLocaleString('en');
    const end = x(at + x0) + context.measureText(text).width / 2;
    if (end + 8 < width - MARGIN.right - context.measureText(words).width) context.fillText(text, x(at + x0), height - MARGIN.bottom + 5);
  }
  context.textAlign = 'right';
  context.fillText(words, width - MARGIN.right, height - MARGIN.bottom + 5);
  return {x, y};
}

/// The bands of sessions: from which place on, and up to which; none where there is but one.
const bandsOf = (sessions, places) => sessions.length < 2 ? [] : sessions.map(({name, first}, i) =>
  ({name, first, end: i + 1 < sessions.length ? sessions[i + 1].first : Math.max(places, first)}));

/// Sessions of the map as bands, every second one shaded.
function drawSessions({context, width}, bands, y) {
  context.fillStyle = colour('line');
  context.globalAlpha = .45;
  bands.forEach(({first, end}, i) => {
    if (i % 2) context.fillRect(MARGIN.left, y(end), width - MARGIN.right - MARGIN.left, y(first) - y(end));
  });
  context.globalAlpha = 1;
}

/// Their names, upon whatever lies there.
function nameSessions({context}, bands, y) {
  context.textAlign = 'left';
  context.textBaseline = 'top';
  context.fillStyle = colour('soft');
  context.strokeStyle = colour('card');
  context.lineWidth = 4;
  for (const {name, first, end} of bands) {
    if (y(first) - y(end) < 18) continue;
    context.strokeText(name, MARGIN.left + 6, y(end) + 3);
    context.fillText(name, MARGIN.left + 6, y(end) + 3);
  }
  context.lineWidth = 1;
}

/// Places over frames. Returns the dots for who points at them.
function drawPlaces(canvas, answers, ownPlaces, picked, marks, sessions, places) {
  const area = sized(canvas);
  const matches = answers.filter((one) => one.status === 'match' && one.match !== null);
  const last = answers.reduce((most, one) => Math.max(most, one.frame), 1);
  const bands = bandsOf(sessions, places);
  const most = matches.reduce((far, one) => Math.max(far, one.match), bands.length ? bands[bands.length - 1].end : ownPlaces ? last : 1);
  const {x, y} = axes(area, 0, last, most, 'frame');
  const {context} = area;
  drawSessions(area, bands, y);
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
  nameSessions(area, bands, y);
  context.fillStyle = colour('warn');
  for (const mark of marks) {
    const right = x(mark.frame) + context.measureText('▲ ' + mark.name).width > area.width;
    context.textAlign = right ? 'right' : 'left';
    context.fillText(right ? mark.name + ' ▲' : '▲ ' + mark.name, x(mark.frame), area.height - MARGIN.bottom - 14);
  }
  const dot = picked && dots.find((one) => one.answer.serial === picked.serial);
  if (dot) {
    context.strokeStyle = colour('bad');
    context.lineWidth = 2;
    context.beginPath();
    context.arc(dot.left, dot.top, 7, 0, 7);
    context.stroke();
  }
  canvas.setAttribute('aria-label', `Places over frames: ${counted(matches.length, 'match', 'es')} in ${counted(last, 'frame')}` +
    (bands.length ? '; sessions ' + bands.map(({name}) => name).join(', ') : ''));
  return dots;
}

function drawProbability(canvas, answers, least) {
  const area = sized(canvas);
  const shown = answers.slice(-1500);
  // Answers come in any order.
  const first = shown.reduce((least, one) => Math.min(least, one.frame), shown.length ? shown[0].frame : 0);
  const last = shown.reduce((most, one) => Math.max(most, one.frame), 1);
  const {x, y} = axes(area, first, last, 1, 'frame');
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
