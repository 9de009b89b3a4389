// SPDX-License-Identifier: MIT
// Pictures side by side, and the list of loops, a page at a time.

const LOOPS_A_PAGE = 12;

/// What is asked of the server; in a report everything is in the page, and there are no pictures.
const report = byId('report') ? JSON.parse(byId('report').textContent) : null;
const ask = (path) => fetch(path).then((reply) => reply.ok ? reply.json() : Promise.reject(reply));

let token = '';
async function change(path, wish) {
  const reply = await fetch(path, {method: 'POST', body: JSON.stringify(wish),
    headers: {'Content-Type': 'application/json', 'Authorization': 'Bearer ' + token}}).catch(() => null);
  if (!reply) {
    show('said', 'Not done: the robot is out of reach.');
    return false;
  }
  const said = reply.headers.get('Content-Type') === 'application/json' ? await reply.json() : {error: await reply.text()};
  show('said', said.error ? 'Not done: ' + said.error : 'Done.');
  return reply.ok;
}

/// A picture that is asked for again where the server has too much to do.
function picture(of, n, what) {
  const image = make('img', {alt: `${what} ${n}`, width: 160, height: 120});
  let tries = 0;
  image.onerror = () => {
    if (++tries > 3) image.replaceWith(make('div', {class: 'none'}, 'no picture is kept'));
    else setTimeout(() => { image.src = `/api/picture?of=${of}&number=${n}&try=${tries}`; }, 1500 * tries);
  };
  image.src = `/api/picture?of=${of}&number=${n}`;
  return image;
}

function caption(what, wanted, kept) {
  return make('figcaption', {}, `${what} ${number(wanted)}` + (kept === wanted ? '' : ` (picture of ${number(kept)})`));
}

/// The kept picture nearest to the wanted one, with its neighbours beneath where they are wanted.
function side(of, what, wanted, around, neighbours) {
  const nearest = around.reduce((best, one) => Math.abs(one - wanted) < Math.abs(best - wanted) ? one : best, around[0]);
  if (nearest === undefined) {
    return make('figure', {}, make('div', {class: 'none'}, report ? 'a report has no pictures' : 'no picture is kept'),
      make('figcaption', {}, `${what} ${number(wanted)}`));
  }
  const figure = make('figure', {}, picture(of, nearest, what), caption(what, wanted, nearest));
  if (neighbours) {
    figure.append(make('div', {class: 'strip'}, ...around.filter((one) => one !== nearest).map((one) =>
      make('figure', {}, picture(of, one, what), make('figcaption', {}, number(one))))));
  }
  return figure;
}

/// Shows a frame beside its place in an element, and beside another one where two look alike.
async function showPair(element, frame, place, neighbours, other = null) {
  const wish = `${frame}/${place}/${other}/${neighbours}`;
  if (element.dataset.pair === wish) return;
  element.dataset.pair = wish;
  const query = Object.entries({frame, place, runner_up: other}).filter(([, n]) => n !== null).map((one) => one.join('=')).join('&');
  const around = report ? {} : await ask('/api/pictures?' + query).catch(() => ({}));
  if (element.dataset.pair !== wish) return;  // something newer is wanted by now
  const sides = [side('frame', 'frame', frame, around.frame || [], neighbours),
    place === null ? make('figure', {}, make('div', {class: 'none'}, 'no place'), make('figcaption', {}, 'place –'))
                   : side('place', 'place', place, around.place || [], neighbours)];
  if (other !== null) sides.push(side('place', 'or place', other, around.runner_up || [], neighbours));
  element.classList.toggle('three', other !== null);
  if (neighbours && element.childElementCount > 0) {
    // What is there stays until the new pictures have come, or take too long.
    const images = sides.flatMap((one) => [...one.querySelectorAll('img')]);
    await Promise.race([Promise.all(images.map((image) => image.decode().catch(() => {}))),
      new Promise((done) => setTimeout(done, 3000))]);
    if (element.dataset.pair !== wish) return;
  }
  element.replaceChildren(...sides);
}

const list = {count: 0, page: 0, shown: ''};

function loopItem(loop) {
  const pair = make('div', {class: 'pair'});
  const place = loop.robot === undefined ? placeName(loop.match)
                                         : `${number(loop.match)} of robot ${loop.robot}, session ${loop.session}`;
  const item = make('li', {class: loop.verdict, 'data-loop': loop.number}, pair, make('p', {},
    `Loop ${number(loop.number + 1)}: frame ${number(loop.frame)} is place ${place}, ` +
    (loop.probability === null ? `uniqueness ${loop.uniqueness.toFixed(2)}` : `probability ${loop.probability.toFixed(3)}`) +
    (loop.time_s === null ? '' : `, at ${loop.time_s.toFixed(1)} s`)));
  // Other robots tell no pictures, and their maps are not here.
  if (!report && loop.robot === undefined) showPair(pair, loop.frame, loop.match, false);
  else pair.remove();
  if (token && loop.robot === undefined) {
    const verdicts = make('p');
    for (const [verdict, word] of [['accepted', 'accept'], ['rejected', 'reject']]) {
      const button = make('button', {'aria-pressed': String(loop.verdict === verdict),
        'aria-label': `${word} loop ${loop.number + 1}`}, word);
      button.onclick = async () => {
        const wanted = loop.verdict === verdict ? 'none' : verdict;
        if (!await change('/api/verdict', {loop: loop.number, frame: loop.frame, match: loop.match, verdict: wanted})) return;
        loop.verdict = wanted === 'none' ? null : wanted;
        item.replaceWith(loopItem(loop));
      };
      verdicts.append(button, ' ');
    }
    item.append(verdicts);
  } else if (loop.verdict) {
    item.append(make('p', {}, loop.verdict + ' by a person'));
  }
  return item;
}

/// The newest loops first.
async function showLoops(count) {
  list.count = count;
  const pages = Math.max(1, Math.ceil(count / LOOPS_A_PAGE));
  list.page = Math.min(list.page, pages - 1);
  show('loops-text', count === 0 ? 'None yet.' : `${counted(count, 'accepted match', 'es')}, the newest first.`);
  show('loops-page', `page ${number(list.page + 1)} of ${number(pages)}`);
  byId('newer').disabled = list.page === 0;
  byId('older').disabled = list.page === pages - 1;
  const end = Math.max(0, count - list.page * LOOPS_A_PAGE);
  const first = Math.max(0, end - LOOPS_A_PAGE);
  if (list.shown === `${first}-${end}`) return;
  list.shown = `${first}-${end}`;
  const {loops} = report ? {loops: report.loops.slice(first, end)}
                         : await ask(`/api/loops?first=${first}&count=${end - first}`).catch(() => ({}));
  if (list.shown !== `${first}-${end}`) return;
  if (!loops) {
    list.shown = '';  // so that they are asked for again
    return;
  }
  const known = new Map([...byId('loops').children].map((item) => [item.dataset.loop, item]));
  byId('loops').replaceChildren(...loops.reverse().map((loop) => known.get(String(loop.number)) || loopItem(loop)));
}
byId('newer').onclick = () => { --list.page; showLoops(list.count); };
byId('older').onclick = () => { ++list.page; showLoops(list.count); };
