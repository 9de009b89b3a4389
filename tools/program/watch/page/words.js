// SPDX-License-Identifier: MIT
'use strict';
// What the names of the JSON lines mean, and what a status says in a sentence.

const GATES = ['no_frame', 'frame_error', 'warming_up', 'waiting', 'no_candidate', 'not_unique', 'new_place',
  'unsure', 'match'];

const HELP = {
  match: 'the robot has been here before; of an answer, the place; of the stages, searching the map',
  unsure: 'it may have been, but the evidence does not suffice',
  new_place: 'it is somewhere new, for all that is known',
  not_unique: 'there is a best place, but another one looks nearly as much alike',
  no_candidate: 'nothing to compare with yet, or no line fits into the map',
  warming_up: 'frames without an answer so far',
  waiting: 'frames whose answer is not sure yet',
  frame_error: 'frames that could not be read or described',
  no_frame: 'times that no frame came in time',
  frames: 'frames that were taken up',
  newest: 'the frame taken up last',
  time_s: 'when that was, in seconds since the first frame',
  now: 'where it is believed to be: the likeliest place, and that it is somewhere new',
  age_ms: 'how old its picture was when it was taken up, milliseconds; of live sources',
  deadline_missed: 'frames that broke a limit of the budget',
  missed: 'which limits the newest frame broke',
  dropped: 'frames that were dropped for newer ones',
  lost: 'frames that the camera never delivered',
  overloaded: 'frames under the overload policy',
  unseen: 'frames that went by too fast to be shown here; they are counted all the same',
  places: 'places in the map, and how many it has room for',
  saved: 'frames of this drive that are on the disk for good',
  sessions: 'drives in the map, this one among them',
  fleet: 'what is known of other robots; loops with their places are listed by robot, and are in no pose graph, since their poses are not known',
  candidates: 'rows of the map that got a score at this frame',
  distances: 'descriptor distances computed for this frame',
  k: 'candidate ranges in force; 0 where all rows are candidates',
  full_search: 'whether all rows were candidates',
  map_full: 'whether the newest frame could not become a place, because the map is full',
  scanned: 'rows of the map looked at for this frame, to find the robot wherever it is',
  memory_planned: 'bytes of map and matcher, taken before the first frame',
  memory_used: 'bytes that the whole program has in memory',
  probability: 'that the robot was there: of answers that say .9, nine in ten are right',
  score: 'mean difference along the line through the place, 0 to 2; lower is better',
  uniqueness: 'score by that of the next best place elsewhere; lower is more certain',
  velocity: 'slope of that line, places a frame: 1 is as fast as on the earlier drive',
  head: 'the place on that line that goes with the newest frame of its window',
  runner_up: 'the other place, where two look alike',
  status: 'how far a frame came: one of the words from match to no_frame',
  answers: 'what is said in the end of frames: one answer a frame, some frames later',
  frame: 'the frame that an answer is about',
  latency_ms: 'milliseconds that the stages took: grab, describe, match, and total',
  grab: 'reading and decoding a picture',
  describe: 'turning it into a descriptor',
  total: 'all stages together',
  fault: 'why a frame could not be read',
  remark: 'what is odd about one that could',
  sequence: 'the camera\'s own number of the newest frame',
  capture: 'the camera and its mode',
  method: 'how places are searched',
  ds: 'length of the sequences that are compared, in frames',
};

const number = (value) => value === null || value === undefined ? '–' : value.toLocaleString('en');
/// `1 frame`, `2 frames`. `more` is what several of them end with.
const counted = (value, thing, more = 's') => `${number(value)} ${thing}${value === 1 ? '' : more}`;
const percent = (value) => value === null || value === undefined ? '–' : (100 * value).toFixed(1) + ' %';
const bytes = (value) => value ? (value < 1e6 ? (value / 1e3).toFixed(0) + ' kB' : (value / 1e6).toFixed(1) + ' MB') : '–';
const milliseconds = (value) => value === undefined || value === null ? '–' : value.toFixed(value < 10 ? 2 : 1);

/// The last part of a path: `drive` of `/data/drive`.
const lastPart = (path) => path.replace(/\/+$/, '').split('/').pop() || path;

/// An answer in words. `name` says what a place is called.
function sentence(status, name) {
  const answer = status.answer;
  const now = status.frame && status.frame.now;
  if (status.frame && status.frame.status === 'no_frame') return 'No frame comes: ' + (status.frame.fault || 'the camera is silent') + '.';
  if (!answer) return status.frame ? 'Warming up: no frame has an answer yet.' : 'No frame has come yet.';
  const at = 'frame ' + number(answer.frame);
  const place = answer.match === null ? 'none' : 'place ' + name(answer.match);
  const other = answer.runner_up === undefined ? '' : ` and like place ${name(answer.runner_up)}`;
  switch (answer.status) {
    case 'match': return `Been here before: ${at} is ${place}.`;
    case 'unsure': return `Not sure: ${at} may be ${place}, but the evidence does not suffice.`;
    case 'new_place': return 'Somewhere new, for all that is known.';
    case 'not_unique': return `No answer: two places look alike, see them: ${at} looks like ${place}${other}.`;
    case 'no_candidate': return 'No answer: there is nothing to compare with yet.';
    case 'frame_error': return `No answer: ${at} could not be read` + (status.frame.fault ? ': ' + status.frame.fault : '') + '.';
    default: return now ? `Waiting for more evidence; likeliest is place ${name(now.place)}.` : 'Warming up.';
  }
}

/// An element with attributes and children; text is text, never markup.
function make(name, attributes, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (value !== null && value !== undefined) element.setAttribute(key, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}
const byId = (id) => document.getElementById(id);
const show = (id, text) => { const at = byId(id); if (at.textContent !== text) at.textContent = text; };

/// Fills a list of terms; each has its help text.
function fillTerms(id, terms) {
  const list = byId(id);
  // One term may leave as another comes.
  const shown = [...list.querySelectorAll('dt')].map((term) => term.textContent);
  if (shown.length !== terms.length || terms.some(([name], i) => name !== shown[i])) {
    list.replaceChildren(...terms.flatMap(([name]) => [
      make('dt', {}, HELP[name] ? make('abbr', {title: HELP[name]}, name) : name), make('dd')]));
  }
  terms.forEach(([, value], i) => {
    const at = list.children[2 * i + 1];
    if (at.textContent !== value) at.textContent = value;
  });
}
