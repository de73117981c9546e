// A flight in motion: the vehicle over its target, what its camera sees, and a slider for the time.
"use strict";

for (const figure of document.querySelectorAll("[data-player]")) {
  new Player(figure, JSON.parse(document.getElementById(figure.dataset.player).textContent));
}

function reveal() {  // a link into what is folded opens it
  const target = location.hash.length > 1 && document.getElementById(location.hash.slice(1));
  let folded = target && target.parentElement.closest("details");
  if (!folded) return;
  for (; folded; folded = folded.parentElement.closest("details")) folded.open = true;
  target.scrollIntoView();
}
addEventListener("hashchange", reveal);
reveal();

for (const event of ["beforeprint", "afterprint"]) {  // what is folded is printed too
  addEventListener(event, () => {
    for (const details of document.querySelectorAll("details")) {
      if (event === "beforeprint") details.dataset.open = details.open;
      details.open = event === "beforeprint" || details.dataset.open === "true";
    }
  });
}

function Player(root, flight) {
  const part = (name) => root.querySelector(`[data-part="${name}"]`);
  const [space, image] = [part("space"), part("image")];
  const [slider, button, chooser] = [part("time"), part("play"), part("span")];
  const WATCHED = 12;  // seconds in which a span is shown
  const views = { "3d": [0.65, 0.42], above: [-Math.PI / 2, 1.5707], side: [-Math.PI / 2, 0] };
  for (const s of flight.spans) s.image = s.image.map((row) => row.map((x) => x ?? NaN));  // unseen
  let span = flight.spans[0], time = 0, playing = false, before = 0;
  let [azimuth, elevation] = views["3d"], zoom = 1;

  // --- vectors ---------------------------------------------------------------------------------
  const add = (a, b) => a.map((x, i) => x + b[i]);
  const sub = (a, b) => a.map((x, i) => x - b[i]);
  const scale = (s, a) => a.map((x) => s * x);
  const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
  const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
  ];
  const unit = (a) => scale(1 / (Math.hypot(...a) || 1), a);
  const turned = ([w, ...v], a) => {  // a body vector in the world
    const t = scale(2, cross(v, a));
    return add(a, add(scale(w, t), cross(v, t)));
  };

  // --- the flight at a time --------------------------------------------------------------------
  function indexAt(t) {
    const times = span.time;
    let low = 0, high = times.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle; else high = middle;
    }
    return low;
  }

  function stateAt(t) {
    const i = indexAt(t), j = Math.min(i + 1, span.time.length - 1);
    const gap = span.time[j] - span.time[i];
    const share = gap > 0 ? Math.min(1, Math.max(0, (t - span.time[i]) / gap)) : 0;
    const mix = (a, b) => (Array.isArray(a) ? a.map((x, k) => mix(x, b[k])) : a + share * (b - a));
    const of = (name) => mix(span[name][i], span[name][j]);
    return {
      index: i, position: of("position"), attitude: unit(of("attitude")), tilt: of("tilt"),
      thrust: of("thrust"), image: pairs(of("image")),
    };
  }

  function pairs(flat) {
    return Array.from({ length: flat.length / 2 }, (_, i) => flat.slice(2 * i, 2 * i + 2));
  }

  // --- what holds the scene: world frame, z down -----------------------------------------------
  const everything = flight.spans.flatMap((s) => s.position).concat(flight.target, [flight.goal]);
  const low = [0, 1, 2].map((k) => Math.min(...everything.map((p) => p[k])));
  const high = [0, 1, 2].map((k) => Math.max(...everything.map((p) => p[k])));
  const centre = scale(0.5, add(low, high));
  const radius = Math.hypot(...sub(high, low)) / 2;
  const ground = Math.max(...flight.target.map((p) => p[2]));
  const grid = nice(Math.max(high[0] - low[0], high[1] - low[1]) / 6);

  function nice(x) {
    const power = 10 ** Math.floor(Math.log10(x));
    return power * [1, 2, 5, 10].find((n) => n * power >= 0.999 * x);
  }

  // --- drawing ---------------------------------------------------------------------------------
  function colours() {
    const style = getComputedStyle(root);
    const of = (name) => style.getPropertyValue(`--${name}`).trim();
    return {
      ink: of("ink"), muted: of("muted"), line: of("line"), path: of("blue"), goal: of("green"),
      target: of("orange"), front: of("amber"),
      points: ["blue", "orange", "green", "pink", "amber", "sky"].map(of),
    };
  }

  function sized(canvas) {
    const ratio = devicePixelRatio || 1, { width, height } = canvas.getBoundingClientRect();
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.lineJoin = pen.lineCap = "round";
    pen.font = `12px ${getComputedStyle(root).fontFamily}`;
    return { pen, width, height };
  }

  function line(pen, points, colour, width = 1, dash = []) {
    pen.beginPath();
    points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.stroke();
    pen.setLineDash([]);
  }

  function square(pen, [x, y], colour, size, filled) {
    pen.lineWidth = 1.5;
    pen.fillStyle = pen.strokeStyle = colour;
    pen[filled ? "fillRect" : "strokeRect"](x - size / 2, y - size / 2, size, size);
  }

  function disc(pen, [x, y], colour, size) {
    pen.beginPath();
    pen.arc(x, y, size, 0, 2 * Math.PI);
    pen.fillStyle = colour;
    pen.fill();
  }

  function drawSpace(state, c) {
    const { pen, width, height } = sized(space);
    const toEye = [
      Math.cos(elevation) * Math.cos(azimuth), -Math.cos(elevation) * Math.sin(azimuth),
      -Math.sin(elevation),
    ];
    const forward = scale(-1, toEye);
    const right = [-Math.sin(azimuth), -Math.cos(azimuth), 0];  // level, and at right angles to it
    const up = cross(right, forward);
    const far = 4 * radius;
    const flat = (p) => {  // on a plane before the eye, in no unit yet
      const d = sub(p, centre), depth = far + dot(d, forward);
      return [dot(d, right) / depth, -dot(d, up) / depth];
    };
    const ends = [0, 1].map((k) => [grid * Math.floor(low[k] / grid), grid * Math.ceil(high[k] / grid)]);
    const corners = ends[0].flatMap((x) => ends[1].map((y) => [x, y, ground]));
    const [us, vs] = [0, 1].map((k) => corners.concat(everything).map((p) => flat(p)[k]));
    const [u0, u1, v0, v1] = [Math.min(...us), Math.max(...us), Math.min(...vs), Math.max(...vs)];
    const room = { side: 34, top: 40, bottom: 36 };
    const size = zoom * Math.min(
      (width - 2 * room.side) / (u1 - u0), (height - room.top - room.bottom) / (v1 - v0 || 1e-9));
    const at = (p) => {
      const [u, v] = flat(p);
      return [
        width / 2 + size * (u - (u0 + u1) / 2),
        (height + room.top - room.bottom) / 2 + size * (v - (v0 + v1) / 2),
      ];
    };
    for (const k of [0, 1]) {
      for (let x = ends[k][0]; x <= ends[k][1] + grid / 2; x += grid) {
        const mark = (y) => (k ? at([y, x, ground]) : at([x, y, ground]));
        line(pen, ends[1 - k].map(mark), c.line);
      }
    }
    const corner = [ends[0][0], ends[1][0], ground];
    pen.fillStyle = c.muted;
    ["x", "y"].forEach((name, k) => {
      const tip = corner.slice();
      tip[k] = ends[k][1];
      line(pen, [at(corner), at(tip)], c.muted, 1.5);
      tip[k] += 0.35 * grid;
      pen.textAlign = "center";
      pen.fillText(name, at(tip)[0], at(tip)[1] + 4);
    });
    const shadow = (p) => [p[0], p[1], ground];
    line(pen, span.position.map(shadow).map(at), c.line, 2);
    line(pen, span.position.map(at), c.muted, 1, [2, 3]);
    const flown = span.position.slice(0, state.index + 1).concat([state.position]);
    line(pen, flown.map(at), c.path, 2.2);
    line(pen, [at(state.position), at(shadow(state.position))], c.muted, 1, [1, 3]);
    disc(pen, at(shadow(state.position)), c.muted, 2.5);
    for (const p of flight.target) {
      line(pen, [at(state.position), at(p)], c.line, 1);
      square(pen, at(p), c.target, 8, true);
    }
    const [gx, gy] = at(flight.goal);
    line(pen, [[gx - 7, gy], [gx + 7, gy]], c.goal, 2);
    line(pen, [[gx, gy - 7], [gx, gy + 7]], c.goal, 2);
    pen.beginPath();
    pen.arc(gx, gy, 7, 0, 2 * Math.PI);
    pen.stroke();
    drawVehicle(pen, state, at, c);
    pen.fillStyle = c.muted;
    pen.textAlign = "left";
    const drawn = flight.drawn_size === 1 ? "to scale" : `${flight.drawn_size} × its size`;
    pen.fillText(`grid ${grid} m, vehicle drawn ${drawn}`, 8, height - 8);
  }

  function drawVehicle(pen, state, at, c) {
    const place = (p) => at(add(state.position, turned(state.attitude, scale(flight.drawn_size, p))));
    const reach = 0.5 * flight.arm;
    flight.rotors.forEach((rotor) => {
      const circle = Array.from({ length: 25 }, (_, k) => {
        const angle = (2 * Math.PI * k) / 24;
        return place(add(rotor, [reach * Math.cos(angle), reach * Math.sin(angle), 0]));
      });
      line(pen, [place([0, 0, 0]), place(rotor)], c.ink, 2.5);
      line(pen, circle, rotor[0] > 0 ? c.front : c.path, 2);
    });
    disc(pen, place([0, 0, 0]), c.ink, 3.5);
  }

  function drawImage(state, c) {
    const { pen, width, height } = sized(image);
    const seen = flight.spans.flatMap((s) => s.image.flatMap(pairs)).concat(flight.goal_image, [[0, 0]])
      .filter((p) => !isNaN(p[0]));
    const [edge, lens] = [flight.image_size, flight.lens];
    if (lens) seen.push([-lens, -lens], [lens, lens]);
    if (edge) seen.push([-edge[0] / 2, -edge[1] / 2], [edge[0] / 2, edge[1] / 2]);
    const ends = [0, 1].map((k) => seen.map((p) => p[k])).map((v) => [Math.min(...v), Math.max(...v)]);
    const reach = Math.max(ends[0][1] - ends[0][0], ends[1][1] - ends[1][0]) * 0.58 || 1;
    const size = Math.min(width, height) / 2 / reach;
    const at = ([x, y]) => [
      width / 2 + size * (x - (ends[0][0] + ends[0][1]) / 2),
      height / 2 + size * (y - (ends[1][0] + ends[1][1]) / 2),
    ];
    const [ox, oy] = at([0, 0]);
    line(pen, [[0, oy], [width, oy]], c.line);
    line(pen, [[ox, 0], [ox, height]], c.line);
    if (edge) {
      const [[x0, y0], [x1, y1]] = [at([-edge[0] / 2, -edge[1] / 2]), at([edge[0] / 2, edge[1] / 2])];
      line(pen, [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], c.muted, 1, [4, 3]);
    }
    if (lens) {
      const around = (k) => at([lens * Math.cos(k * Math.PI / 60), lens * Math.sin(k * Math.PI / 60)]);
      line(pen, Array.from({ length: 121 }, (_, k) => around(k)), c.front);
    }
    for (const p of flight.goal_image) square(pen, at(p), c.ink, 11, false);
    const flown = span.image.slice(0, state.index + 1).map(pairs).concat([state.image]);
    state.image.forEach((p, i) => {
      const colour = c.points[i % c.points.length];
      line(pen, flown.map((points) => at(points[i])), colour, 1.5);
      disc(pen, at(p), colour, 4);
    });
    pen.fillStyle = c.muted;
    pen.textAlign = "left";
    pen.fillText(`what the camera sees; squares: goal${lens ? "; circle: lens" : ""}`, 8, height - 8);
  }

  function draw() {
    const state = stateAt(time), c = colours();
    const digits = span.time.at(-1) >= 100 ? 1 : 2;
    const away = Math.hypot(...sub(state.position, flight.goal));
    const told = {
      clock: `${time.toFixed(digits)} s`, tilt: `${state.tilt.toFixed(3)}°`,
      position: `(${state.position.map((x) => x.toFixed(3).replace(/^-(?=0\.0+$)/, "").replace("-", "−")).join(", ")}) m`,
      away: `${away.toFixed(3)} m`, thrust: `${state.thrust.toPrecision(5)} N`,
    };
    for (const [name, text] of Object.entries(told)) part(name).textContent = text;
    slider.setAttribute("aria-valuetext", told.clock);
    drawSpace(state, c);
    drawImage(state, c);
  }

  // --- controls --------------------------------------------------------------------------------
  function show(t) {
    time = Math.min(Math.max(t, 0), span.time.at(-1));
    slider.value = time;
    draw();
  }

  function choose(k) {
    span = flight.spans[k];
    const duration = span.time.at(-1), pace = duration / WATCHED;
    slider.max = duration;
    slider.step = duration / 1000 || 1;
    slider.disabled = button.disabled = duration === 0;
    part("pace").textContent = `plays at ${pace < 10 ? pace.toPrecision(2) : Math.round(pace)} × real time`;
    show(0);
  }

  function play(wanted) {
    playing = wanted;
    button.textContent = playing ? "Pause" : "Play";
    if (playing && time >= span.time.at(-1)) show(0);
    before = 0;
    if (playing) requestAnimationFrame(tick);
  }

  function tick(now) {
    if (!playing) return;
    if (before) show(time + ((now - before) / 1000) * (span.time.at(-1) / WATCHED));
    before = now;
    if (time >= span.time.at(-1)) play(false);
    else requestAnimationFrame(tick);
  }

  function look(a, e, z = zoom) {
    [azimuth, elevation, zoom] = [a, Math.min(1.5707, Math.max(-0.2, e)), Math.min(8, Math.max(0.4, z))];
    draw();
  }

  flight.spans.forEach((s, k) => chooser.append(new Option(s.name, k)));
  chooser.parentElement.hidden = flight.spans.length < 2;
  chooser.addEventListener("change", () => { play(false); choose(Number(chooser.value)); });
  slider.addEventListener("input", () => { play(false); show(Number(slider.value)); });
  button.addEventListener("click", () => play(!playing));
  for (const choice of root.querySelectorAll("[data-view]")) {
    choice.addEventListener("click", () => look(...views[choice.dataset.view], 1));
  }
  let held = null;
  space.addEventListener("pointerdown", (e) => {
    held = [e.clientX, e.clientY];
    space.setPointerCapture(e.pointerId);
  });
  space.addEventListener("pointermove", (e) => {
    if (!held) return;
    const rise = e.pointerType === "touch" ? 0 : 0.008 * (e.clientY - held[1]);
    look(azimuth + 0.008 * (e.clientX - held[0]), elevation + rise);
    held = [e.clientX, e.clientY];
  });
  for (const name of ["pointerup", "pointercancel"]) space.addEventListener(name, () => { held = null; });
  space.addEventListener("keydown", (e) => {
    const moves = {
      ArrowLeft: [azimuth - 0.1, elevation], ArrowRight: [azimuth + 0.1, elevation],
      ArrowUp: [azimuth, elevation + 0.1], ArrowDown: [azimuth, elevation - 0.1],
      "+": [azimuth, elevation, zoom * 1.2], "-": [azimuth, elevation, zoom / 1.2],
    };
    if (e.key === " ") play(!playing);
    else if (moves[e.key]) look(...moves[e.key]);
    else return;
    e.preventDefault();
  });
  new ResizeObserver(draw).observe(space);
  for (const query of ["(prefers-color-scheme: dark)", "print"]) {
    matchMedia(query).addEventListener("change", draw);
  }
  choose(0);
}
