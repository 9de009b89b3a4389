// SPDX-License-Identifier: MIT
// The page: takes what the server tells, and shows it.

const MOST_ANSWERS = 8000;
const view = {status: null, frames: [], nextFrame: 0, answers: [], nextAnswer: 0, dots: [], picked: null, marks: [], drawn: ''};

const toAnswer = ([serial, frame, status, match, probability]) => ({serial, frame, status: GATES[status], match, probability});

/// Takes frames and answers that are newer than what is here. Returns whether some are missing.
function takeNews(news) {
  const gap = news.first_frame > view.nextFrame ||
    (news.answers.length > 0 && news.answers[0][0] > view.nextAnswer);
  view.frames.push(...news.frames.slice(Math.max(0, view.nextFrame - news.first_frame)));
  view.nextFrame = Math.max(view.nextFrame, news.first_frame + news.frames.length);
  view.frames.splice(0, view.frames.length - 300);
  for (const row of news.answers) {
    if (row[0] < view.nextAnswer) continue;
    view.answers.push(toAnswer(row));
    view.nextAnswer = row[0] + 1;
  }
  if (view.answers.length > MOST_ANSWERS) view.answers = view.answers.filter((one, i) => i % 2 === 0);
  return gap;
}

async function takeHistory() {
  const past = report ? report.history : await ask('/api/history');
  view.frames = [];
  view.answers = [];
  view.nextFrame = past.first_frame;
  view.nextAnswer = 0;
  takeNews(past);
  view.marks = report ? [] : await ask('/api/marks');
}

function showStages(status) {
  const budget = status.run.budget_ms || {};
  byId('stages').replaceChildren(...Object.entries(status.stages).map(([name, stage]) => make('tr', {},
    make('th', {scope: 'row'}, name), make('td', {}, milliseconds(stage.p50_ms)), make('td', {}, milliseconds(stage.p99_ms)),
    make('td', budget[name] && stage.max_ms > budget[name] ? {class: 'bad'} : {}, milliseconds(stage.max_ms)),
    make('td', {}, budget[name] ? milliseconds(budget[name]) : '–'))));
}

/// What was wrong with frames, the newest first.
function showTroubles(troubles) {
  const texts = troubles.map(({frame, times, text}) =>
    (frame === null ? text : `frame ${number(frame)}: ${text}`) + (times > 1 ? ` (${number(times)} times)` : '')).reverse();
  byId('troubles').hidden = texts.length === 0;
  if (byId('troubles').dataset.shown === texts.join('\n')) return;
  byId('troubles').dataset.shown = texts.join('\n');
  byId('troubles').replaceChildren(...texts.map((text) => make('li', {}, text)));
}

const yes = (is) => is === null ? '–' : is ? 'yes' : 'no';

/// Of the newest frame.
function newestTerms({newest, time_s: time, now, age_ms: age, missed}) {
  return [['newest', number(newest)], ['time_s', time === null ? '–' : time.toFixed(1)],
    ['now', now ? `place ${placeName(now.place)}: ${percent(now.probability)}; new_place: ${percent(now.new_place)}` : '–'],
    ['age_ms', age ? milliseconds(age) : '–'], ['missed', missed ? missed.join(', ') : 'none']];
}

function showStatus(status) {
  const {run, counts, frame, map, health} = status;
  const gates = counts.gates;
  const drives = [run.source, run.reference || run.map].filter(Boolean);
  show('source', drives.map(lastPart).join(' in '));
  byId('source').title = drives.join(' in ');
  show('version', run.conditions || '');
  const word = status.state === 'paused' ? 'paused: no frame is taken' : 'running well';
  byId('health').className = status.state === 'ended' ? 'soft' : health.ok ? status.state === 'paused' ? 'warn' : 'good' : 'bad';
  show('health', report ? 'A run that is over.' : status.state === 'ended' ? 'The run has ended.' :
    health.ok ? word : 'in trouble: ' + health.why);
  show('sentence', report ? `${number(gates.match)} of ${number(counts.frames)} frames were recognised.` : sentence(status, placeName));
  const answer = status.answer;
  show('detail', !report && answer && answer.match !== null && answer.status !== 'new_place' ?
    [answer.probability !== null && `probability ${percent(answer.probability)}`,
      answer.uniqueness !== null && `uniqueness ${answer.uniqueness.toFixed(2)}`,
      answer.score !== null && `score ${answer.score.toFixed(3)}`,
      answer.velocity !== null && `velocity ${answer.velocity.toFixed(2)}`, `head ${number(answer.head)}`].filter(Boolean).join(' · ') : '');
  fillTerms('counts', [['frames', number(counts.frames)], ...['match', 'unsure', 'new_place', 'not_unique', 'no_candidate',
    'warming_up', 'frame_error', 'no_frame'].filter((name) => gates[name] || name === 'match').map((name) => [name, number(gates[name])]),
    ...(frame && !report ? newestTerms(frame) : []), ['deadline_missed', number(counts.misses)], ['dropped', number(counts.dropped)], ['lost', number(counts.lost)],
    ['overloaded', number(counts.overloaded)], ['unseen', number(status.unseen)],
    ...(run.capture ? [['capture', run.capture]] : []), ...(frame && frame.sequence ? [['sequence', number(frame.sequence)]] : [])]);
  showTroubles(status.troubles);
  const once = map.scanned ? Math.ceil(map.places / map.scanned) : 0;
  const room = run.places ? ' of ' + number(run.places) : '';
  const terms = [['places', report ? (run.places ? 'room for ' + number(run.places) : '–') : number(map.places) + room],
    ...(map.saved === undefined ? [] : [['saved', `up to frame ${number(map.saved)}`], ['sessions', sessionNames(run.sessions)]]),
    ...(status.fleet ? [['fleet', `${counted(status.fleet.places, 'place')} of other robots, ${counted(status.fleet.loops, 'loop')} with them`]] : []),
    ['candidates', frame ? number(frame.candidates) : '–'], ['distances', frame ? number(frame.distances) : '–'],
    ['k', frame ? number(frame.k) : '–'], ['full_search', yes(frame && frame.full_search)],
    ['map_full', yes(frame && frame.map_full)],
    ['scanned', map.scanned ? `${number(map.scanned)} of ${number(map.places)}` + (once > 1 ? `; once round the map in ${once} frames` : '; the whole map') : '–'],
    ['memory_planned', bytes(run.memory_planned)], ['memory_used', bytes(map.memory_used)],
    ['method', run.method || '–'], ['ds', number(run.ds)]];
  fillTerms('map', terms.filter(([, value]) => !report || value !== '–'));  // lines do not tell everything
  if (!report) byId('save').hidden = map.saved === undefined;
  showStages(status);
  if (!report) show('pause', status.state === 'paused' ? 'resume' : 'pause');
}

// Of which session a place is, where there are several.
function placeName(place) {
  const sessions = (view.status && view.status.run.sessions) || [];
  const of = sessions.length > 1 && sessions.filter(({first}) => first <= place).pop();
  return number(place) + (of ? ` (${of.name})` : '');
}
const sessionNames = (sessions) => number(sessions.length) +
  (sessions.length > 1 ? `, the newest ${sessions[sessions.length - 1].name}` : '');

// Places are frames of the drive itself, as far as can be told.
const ownPlaces = () => !view.status.run.reference && !view.status.run.sessions && view.answers.every((one) => one.match === null || one.match <= one.frame);

function draw() {
  const status = view.status;
  const decision = status.run.decision || {};
  view.dots = drawPlaces(byId('places'), view.answers, ownPlaces(), view.picked, view.marks, status.run.sessions || [],
    status.map.places);
  if (view.answers.length > 0 && view.answers.every((one) => one.probability === null)) {
    show('probability-text', 'This run decides by uniqueness: no answer has a probability.');
    byId('probability').hidden = true;
  } else {
    const last = (decision.changes || []).slice(-1)[0] || decision;
    drawProbability(byId('probability'), view.answers, last.min_probability);
  }
  drawTimes(byId('times'), view.frames, (status.run.budget_ms || {}).total);
}

function showAll() {
  const status = view.status;
  showStatus(status);
  draw();
  showLoops(report ? status.loops.listed : status.shown.loops);
  const {frame, place, runner_up: other} = report ? {frame: null} : status.shown;
  if (frame !== null && !document.hidden) showPair(byId('pair'), frame, place, true, other);
}

function pick(dot) {
  if (!dot) return;
  view.picked = dot.answer;
  const {frame, match, probability} = dot.answer;
  show('places-picked', `Frame ${number(frame)} is place ${placeName(match)}` +
    (probability === null ? '.' : `, probability ${probability.toFixed(3)}.`));
  byId('picked').hidden = Boolean(report);
  showPair(byId('picked'), frame, match, true);
  draw();
}

byId('places').onclick = (event) => {
  const {left, top} = byId('places').getBoundingClientRect();
  const far = (dot) => Math.hypot(dot.left - (event.clientX - left), dot.top - (event.clientY - top));
  const nearest = view.dots.reduce((best, dot) => !best || far(dot) < far(best) ? dot : best, null);
  if (nearest && far(nearest) < 24) pick(nearest);
};
byId('places').onkeydown = (event) => {
  const step = {ArrowRight: 1, ArrowLeft: -1, ArrowUp: 10, ArrowDown: -10}[event.key];
  if (!step || view.dots.length === 0) return;
  event.preventDefault();
  const at = view.dots.findIndex((dot) => view.picked && dot.answer.serial === view.picked.serial);
  pick(view.dots[Math.min(view.dots.length - 1, Math.max(0, at + step))]);
};

function takeToken() {
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) {
    sessionStorage.setItem('token', given);
    history.replaceState(null, '', location.pathname);  // so that it is in no screenshot
  }
  token = sessionStorage.getItem('token') || '';
  byId('control').hidden = !token;
}
function control() {
  byId('pause').onclick = () => change('/api/control', {do: view.status.state === 'paused' ? 'resume' : 'pause'});
  byId('save').onclick = () => change('/api/control', {do: 'save'});
  byId('stop').onclick = () => { if (confirm('Stop the run?')) change('/api/control', {do: 'stop'}); };
  byId('threshold').onsubmit = (event) => {
    event.preventDefault();
    change('/api/control', {do: 'threshold', min_probability: Number(new FormData(event.target).get('least'))});
  };
  byId('mark').onsubmit = async (event) => {
    event.preventDefault();
    if (!await change('/api/control', {do: 'mark', name: new FormData(event.target).get('name')})) return;
    event.target.reset();
    view.marks = await ask('/api/marks');
  };
}

function listen() {
  const events = new EventSource('/api/events');
  let first = true;
  events.onopen = () => { first = true; };
  events.onmessage = async (event) => {
    const news = JSON.parse(event.data);
    // Another run at the same address: all that is here is of the one before.
    if (view.status && view.status.id !== news.status.id) return location.reload();
    view.status = news.status;
    // What was before, and what a slow line has missed.
    if (first || takeNews(news)) {
      first = false;
      await takeHistory();
      takeNews(news);
    }
    requestAnimationFrame(showAll);
  };
  events.onerror = () => {
    // After the run's end the page asks on, for another run at its address.
    if (!view.status || view.status.state !== 'ended') {
      byId('health').className = 'bad';
      show('health', 'not connected: the run has ended, or the robot is out of reach');
    }
    // Refused, as where too many look, the browser does not ask again by itself.
    if (events.readyState === EventSource.CLOSED) setTimeout(listen, 2000);
  };
}

byId('words').replaceChildren(...Object.entries(HELP).flatMap(([name, text]) => [make('dt', {}, name), make('dd', {}, text)]));
byId('legend').replaceChildren(...['grab', 'describe', 'match'].map((name) => make('li', {class: 'swatch-' + name}, name)));
window.addEventListener('resize', () => { if (view.status) draw(); });
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { if (view.status) draw(); });
if (report) {
  view.status = report.status;
  takeHistory().then(showAll);
  for (const id of ['truth', 'monitor', 'control']) byId(id).remove();
  byId('pair').hidden = true;
  document.querySelector('main').className = 'over';
  byId('pair').parentElement.className = 'full';
  show('h-now', 'In short');
} else {
  takeToken();
  control();
  listen();
}
