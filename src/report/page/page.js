// Draws the page's figures from their data: hover, zoom, legend, trial selector, sortable tables, deep links. No network, no library.
"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const TALL = 48, TEXT = 12, BOLD = 0.85, ROOM = 12, RIGHT = 16, NARROW = 250;
  const state = { zoom: new Map(), marks: new Map(), cursor: null };
  const plots = [];
  let data = { columns: [], figures: {} };
  const columns = [];

  // Numbers -----------------------------------------------------------------------------------------------------------------
  const column = (at) => {
    if (!columns[at]) {
      const [low, step, rows] = data.columns[at];
      let last = 0;
      columns[at] = Float64Array.from(rows, (by) => (by === null ? 0 / 0 : low + step * (last += by)));
    }
    return columns[at];
  };
  const bound = (x) => Math.min(1e300, Math.max(-1e300, x));
  const place = (axis, v) => {
    if (axis.kind === "log") return Math.log10(Math.max(v, 1e-307));
    if (axis.kind === "signed") return Math.sign(v) * Math.log10(1 + Math.abs(v) / axis.from);
    return v;
  };
  const value = (axis, p) => {
    if (axis.kind === "log") return 10 ** p;
    if (axis.kind === "signed") return Math.sign(p) * axis.from * (10 ** Math.abs(p) - 1);
    return p;
  };
  const minus = (text) => text.replace("-", "\u2212");
  const shown = (x, digits = 4) => {
    if (!isFinite(x)) return "–";
    if (x !== 0 && (Math.abs(x) >= 1e6 || Math.abs(x) < 1e-4)) return minus(x.toExponential(digits - 1));
    return minus(String(Number(x.toPrecision(digits))));
  };
  const tidy = (x, step) => {
    const decimals = Math.max(0, Math.min(9, -Math.floor(Math.log10(step) + 1e-9)));
    return Math.abs(x) >= 1e7 ? shown(x, 3) : minus((Math.abs(x) < step / 1e6 ? 0 : x).toFixed(decimals));
  };
  const ticks = (axis, [low, high], px, each = 80) => {
    if (axis.texts) return axis.texts;
    const found = [];
    const linear = (low, high, at, wanted) => {
      const rough = (high - low) / wanted, power = 10 ** Math.floor(Math.log10(rough));
      const count = (step) => Math.floor(high / step + 1e-9) - Math.ceil(low / step - 1e-9) + 1;
      const widest = [1, 2, 5].find((digit) => rough <= digit * power) || 10;
      // Two ticks at least: one alone shows no scale.
      const step = power * [10, 5, 2, 1, 0.5, 0.2].find((digit) => digit <= widest && (count(digit * power) > 1 || digit === 0.2));
      for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9 && found.length < 60; k++) found.push([at(k * step), tidy(k * step, step)]);
    };
    const wanted = Math.max(3, px / each);
    if (axis.kind === "linear") linear(low, high, (x) => x, wanted);
    else if (axis.kind === "log") {
      if (high - low < 0.5) linear(10 ** low, 10 ** high, (x) => Math.log10(x), wanted);
      else {
        const digits = high - low < 1.6 ? [1, 2, 3, 5, 7] : high - low < 2.6 ? [1, 2, 5] : [1];
        for (let p = Math.floor(low); p <= high; p++) for (const d of digits) {
          const at = p + Math.log10(d);
          if (at >= low - 1e-9 && at <= high + 1e-9) found.push([at, shown(d * 10 ** p, 3)]);
        }
      }
    } else {
      if (low <= 0 && high >= 0) found.push([0, "0"]);
      const largest = Math.max(Math.abs(value(axis, low)), Math.abs(value(axis, high)));
      for (let p = Math.floor(Math.log10(axis.from)); p <= Math.log10(largest); p++) for (const sign of [1, -1]) {
        const v = sign * 10 ** p, at = place(axis, v);
        if (at >= low && at <= high && Math.abs(v) >= 0.9 * axis.from) found.push([at, shown(v, 3)]);
      }
    }
    return found;
  };

  // Elements ----------------------------------------------------------------------------------------------------------------
  const make = (name, attributes = {}, parent = null, text = null) => {
    const element = document.createElementNS(SVG, name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (text !== null) element.textContent = text;
    if (parent) parent.appendChild(element);
    return element;
  };
  const html = (name, className, parent, text) => {
    const element = document.createElement(name);
    if (className) element.className = className;
    if (text !== undefined) element.textContent = text;
    if (parent) parent.appendChild(element);
    return element;
  };
  const pen = document.createElement("canvas").getContext("2d");
  const wide = (text) => {
    pen.font = TEXT + "px system-ui, DejaVu Sans, sans-serif";
    return pen.measureText(text).width;
  };
  const paint = (color) => "var(--" + color[0] + ")";
  const faint = (color, opacity = 1) => (color[1] ? 0.4 : 1) * opacity;
  const STOPS = [[253, 231, 37], [173, 220, 48], [94, 201, 98], [40, 174, 128], [33, 145, 140], [44, 114, 142], [59, 82, 139], [71, 45, 123], [68, 1, 84]];
  const isDark = () => getComputedStyle(document.documentElement).colorScheme === "dark";
  // What is large stands out from the ground: dark on light, bright on dark, where the darkest colours would drown.
  let dark = isDark();
  const heat = (share) => {
    const along = Math.min(1, Math.max(0, share)), at = dark ? (1 - along) * (STOPS.length - 2.6) : along * (STOPS.length - 1);
    const from = Math.min(Math.floor(at), STOPS.length - 2);
    return "rgb(" + STOPS[from].map((a, i) => Math.round(a + (at - from) * (STOPS[from + 1][i] - a))).join(",") + ")";
  };
  const signs = {
    up: "M-4.5 3.5h9L0-4.5z", down: "M-4.5-3.5h9L0 4.5z", left: "M6-5V5L-4 0z", right: "M-6-5V5L4 0z",
    diamond: "M0-5.5L5.5 0L0 5.5L-5.5 0z", square: "M-4.5-4.5h9v9h-9z",
  };
  const sign = (series, x, y, parent) => {
    const fill = paint(series.color), opacity = faint(series.color);
    if (signs[series.mark]) return make("path", { d: signs[series.mark], transform: `translate(${x} ${y})`, fill, "fill-opacity": opacity }, parent);
    const ring = series.mark === "ring";
    return make("circle", { cx: x, cy: y, r: series.radius, fill: ring ? "none" : fill, "fill-opacity": opacity, stroke: ring ? fill : "none", "stroke-width": 1.5 }, parent);
  };
  const wrapped = (text, room) => {
    if (wide(text) <= room) return [text];
    const lines = [""];
    for (const piece of text.split(/(?<=[ _])/)) {
      if (lines[lines.length - 1] && wide(lines[lines.length - 1] + piece.trim()) > room) lines.push("");
      lines[lines.length - 1] += piece;
    }
    return lines.map((line) => line.trim());
  };

  // A figure ----------------------------------------------------------------------------------------------------------------
  class Plot {
    constructor(figure) {
      this.figure = figure;
      this.name = figure.dataset.figure;
      this.data = data.figures[this.name];
      this.hidden = new Set();
      this.zoomed = new Map();
      this.panels = this.data.rows.flatMap((row) => row.panels);
      this.room = figure.querySelector(".plot");
      this.option = figure.closest("[data-option]");
      this.width = 0;
      this.legend();
      this.area = html("div", "area", this.room);
      this.tip = html("div", "tip", this.room);
      this.tip.hidden = true;
      this.said = html("div", "sr", this.room);
      this.said.setAttribute("aria-live", "polite");
    }
    legend() {
      const entries = new Map();
      for (const panel of this.panels) for (const series of panel.series) if (series.name && !entries.has(series.name)) entries.set(series.name, series);
      const bar = html("div", "legend", this.room);
      for (const [name, series] of entries) {
        const button = html("button", "", bar);
        button.type = "button";
        button.setAttribute("aria-pressed", "true");
        button.title = "show or hide";
        const sample = make("svg", { width: 26, height: 14, "aria-hidden": "true" }, button);
        if (series.kind === "line") make("path", { d: "M1 7h24", stroke: paint(series.color), "stroke-opacity": faint(series.color), "stroke-width": Math.min(4, Math.max(1.6, series.width)), "stroke-dasharray": series.dash ? series.dash.join(" ") : "none" }, sample);
        else if (series.kind === "band") make("rect", { x: 1, y: 2, width: 24, height: 10, fill: paint(series.color), "fill-opacity": faint(series.color, Math.max(0.25, series.opacity)) }, sample);
        else if (series.kind === "dots") make("circle", { cx: 13, cy: 7, r: 3, fill: paint(series.color) }, sample);
        else sign(series, 13, 7, sample);
        button.append(name);
        button.addEventListener("click", () => {
          const off = !this.hidden.delete(name);
          if (off) this.hidden.add(name);
          button.setAttribute("aria-pressed", String(!off));
          this.draw();
        });
      }
      this.reset = html("button", "reset", bar, "Reset zoom");
      this.reset.type = "button";
      this.reset.hidden = true;
      this.reset.addEventListener("click", () => this.unzoom());
    }
    ends(panel) {
      const own = this.zoomed.get(panel) || {};
      const x = (panel.link && state.zoom.get(panel.link)) || own.x || panel.x.ends;
      return { x, y: own.y || panel.y.ends };
    }
    unzoom() {
      this.zoomed.clear();
      const links = new Set(this.panels.map((panel) => panel.link).filter(Boolean));
      links.forEach((link) => { state.zoom.delete(link); state.marks.delete(link); });
      redraw(links, this);
      remember(null);
    }
    zoom(panel, x, y) {
      const own = this.zoomed.get(panel) || {};
      if (x && panel.link) state.zoom.set(panel.link, x);
      this.zoomed.set(panel, { x: x && !panel.link ? x : own.x, y: y || own.y });
      redraw(new Set([panel.link]), this);
      if (x && panel.link) remember(panel.link);
    }
    draw() {
      const width = this.room.clientWidth;
      if (!width) return;
      this.width = width;
      this.area.textContent = "";
      this.frames = [];
      const svg = make("svg", { width, role: "img", tabindex: 0, "aria-label": this.data.title + ". Arrow keys move along it, plus and minus zoom, Escape resets.", class: "drawing" });
      let top = 4;
      for (const row of this.data.rows) {
        const side = width / row.panels.length >= NARROW ? row.panels.length : 1, alone = side === 1 && row.panels.length > 1;
        for (let at = 0; at < row.panels.length; at += side) {
          const panels = row.panels.slice(at, at + side), height = this.tall(row, width);
          const margins = panels.map((panel, i) => this.margins(width, side, at + i));
          // Panels of one row are equally wide.
          const across = (width - margins.reduce((sum, [left, right]) => sum + left + right, 0)) / panels.length;
          const titles = panels.map((panel) => wrapped(panel.title, BOLD * across));
          const lines = Math.max(...panels.map((panel, i) => (panel.title ? titles[i].length : 0)));
          top += lines ? 10 + 15 * lines : ROOM;
          let from = 0;
          panels.forEach((panel, i) => {
            const left = from + margins[i][0], right = left + across;
            from = right + margins[i][1];
            const frame = { panel, left, top, right, bottom: top + height, alone };
            if (panel.title) titles[i].forEach((line, k) => make("text", { x: left, y: top - 8 - 15 * (titles[i].length - 1 - k), class: "head" }, svg, line));
            this.frame(svg, frame);
          });
          const ticked = alone || panels.some((panel) => !panel.x.hidden), labelled = Math.max(...this.frames.slice(-panels.length).map((frame) => frame.lines));
          top += height + (ticked ? 22 : 6) + (labelled ? 5 + 15 * labelled : 0);
        }
      }
      make("title", {}, svg, this.data.title);
      svg.setAttribute("height", top + 4);
      svg.setAttribute("viewBox", `0 0 ${width} ${top + 4}`);
      this.area.appendChild(svg);
      this.svg = svg;
      this.listen();
      this.reset.hidden = !this.panels.some((panel) => this.zoomed.has(panel) || (panel.link && state.zoom.has(panel.link)));
    }
    tall(row, width) {
      // Names that wrap need higher rows.
      const of = (panel) => {
        const lines = Math.max(1, ...panel.y.texts.map((text) => wrapped(text[1], 0.34 * width).length), ...panel.beside.map((text) => wrapped(text[1], 0.3 * width).length));
        return panel.y.texts.length * (13 * lines + 5);
      };
      return Math.max(row.height, ...row.panels.filter((panel) => panel.y.texts).map(of));
    }
    // Room to the left and to the right of a column's panels, which stand in line.
    margins(width, side, column) {
      const alike = side === 1 ? this.panels : this.data.rows.filter((row) => row.panels.length === side).map((row) => row.panels[column]);
      const left = (panel) => {
        const tall = this.data.rows.find((row) => row.panels.includes(panel)).height;
        const texts = panel.y.hidden ? [] : ticks(panel.y, this.ends(panel).y, tall, TALL).map((tick) => wide(tick[1]));
        return Math.min(Math.max(0, ...texts), panel.y.texts ? 0.34 * width : 200) + (panel.y.label ? 20 : 0) + 14;
      };
      const right = (panel) => {
        const cells = panel.series.some((series) => series.kind === "cells");
        return Math.max(RIGHT, ...panel.beside.map((text) => Math.min(wide(text[1]), 0.3 * width) + 10), cells ? 74 : 0);
      };
      return [left, right].map((of) => Math.max(...alike.map(of)));
    }
    frame(svg, frame) {
      const { panel, left, top, right, bottom } = frame, ends = this.ends(panel);
      frame.ends = ends;
      frame.px = (p) => left + ((right - left) * (p - ends.x[0])) / (ends.x[1] - ends.x[0]);
      frame.py = (p) => bottom - ((bottom - top) * (p - ends.y[0])) / (ends.y[1] - ends.y[0]);
      frame.fx = (x) => ends.x[0] + ((x - left) / (right - left)) * (ends.x[1] - ends.x[0]);
      frame.fy = (y) => ends.y[0] + ((bottom - y) / (bottom - top)) * (ends.y[1] - ends.y[0]);
      this.frames.push(frame);
      const inside = (p, [a, b]) => p >= a - 1e-9 && p <= b + 1e-9;
      const told = [];
      for (const [at, text] of ticks(panel.x, ends.x, right - left)) {
        if (!inside(at, ends.x)) continue;
        const x = frame.px(at), reach = wide(text) / 2 + 3;
        make("path", { d: `M${x} ${top}V${bottom}`, class: "grid" }, svg);
        // What would run into a tick that is told is left to the grid.
        if (told.some(([other, its]) => Math.abs(x - other) < reach + its)) continue;
        told.push([x, reach]);
        if (!panel.x.hidden || frame.alone) make("text", { x, y: bottom + 16, "text-anchor": "middle" }, svg, text);
      }
      for (const [at, text] of ticks(panel.y, ends.y, bottom - top, TALL)) {
        if (!inside(at, ends.y)) continue;
        const y = frame.py(at);
        if (!panel.y.texts) make("path", { d: `M${left} ${y}H${right}`, class: "grid" }, svg);
        if (panel.y.hidden && !frame.alone) continue;
        const room = panel.y.texts ? 0.34 * this.width : 400, lines = wrapped(text, room);
        lines.forEach((line, i) => make("text", { x: left - 8, y: y + 4 + 13 * (i - (lines.length - 1) / 2), "text-anchor": "end" }, svg, line));
      }
      make("path", { d: `M${left} ${top}V${bottom}H${right}`, class: "axis" }, svg);
      const label = panel.x.label ? wrapped(panel.x.label, right - left + 40) : [];
      frame.lines = label.length;
      label.forEach((line, i) => make("text", { x: (left + right) / 2, y: bottom + (panel.x.hidden ? 14 : 34) + 15 * i, "text-anchor": "middle", class: "label" }, svg, line));
      if (panel.y.label) {
        const own = ticks(panel.y, ends.y, bottom - top, TALL).map((tick) => wide(tick[1]));
        const x = left - 18 - (panel.y.hidden ? 0 : Math.max(0, ...own));
        make("text", { transform: `translate(${x} ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle", class: "label" }, svg, panel.y.label);
      }
      const id = `${this.name}-${this.frames.length}`;
      const clip = make("clipPath", { id }, svg);
      make("rect", { x: left, y: top, width: Math.max(1, right - left), height: bottom - top }, clip);
      const inner = make("g", { "clip-path": `url(#${id})` }, svg);
      for (const [a, b] of state.marks.get(panel.link) || []) {
        make("rect", { x: frame.px(a) - 1, y: top, width: Math.max(3, frame.px(b) - frame.px(a) + 2), height: bottom - top, class: "spot" }, inner);
      }
      for (const series of panel.series) if (!this.hidden.has(series.name)) this.series(inner, frame, series, svg);
      for (const [v, text] of panel.beside) {
        const y = frame.py(place(panel.y, v));
        const lines = wrapped(text, 0.3 * this.width);
        lines.forEach((line, i) => make("text", { x: right + 8, y: y + 4 + 13 * (i - (lines.length - 1) / 2) }, svg, line));
      }
      frame.over = make("g", {}, svg);
      make("rect", { x: left, y: top, width: Math.max(1, right - left), height: bottom - top, class: "hit", "data-at": this.frames.length - 1 }, svg);
    }
    points(series, key = "points") {
      const [x, y] = series[key];
      return [column(x), column(y)];
    }
    path(frame, xs, ys) {
      // The lowest and the highest point of each column of pixels.
      const parts = [], { panel } = frame, far = frame.right - frame.left;
      let pixel = null, first = 0, low = 0, high = 0, last = 0, pen = false, before = null;
      const flush = () => {
        if (pixel === null) return;
        const x = pixel.toFixed(1);
        for (const y of low === high ? [last] : [first, low, high, last]) parts.push((pen ? "L" : "M") + x + " " + y.toFixed(1)), (pen = true);
        pixel = null;
      };
      for (let i = 0; i < xs.length; i++) {
        if (!isFinite(xs[i]) || !isFinite(ys[i])) { flush(); pen = false; before = null; continue; }
        const x = bound(frame.px(place(panel.x, xs[i]))), y = Math.max(-9e3, Math.min(9e3, bound(frame.py(place(panel.y, ys[i])))));
        if (x < frame.left - far || x > frame.right + far) { flush(); if (before !== null && pen && x > frame.right) parts.push("L" + Math.min(x, 9e4).toFixed(1) + " " + y.toFixed(1)); pen = false; before = [x, y]; continue; }
        if (!pen && before && pixel === null) { parts.push("M" + Math.max(before[0], -9e4).toFixed(1) + " " + before[1].toFixed(1)); pen = true; }
        const at = xs.length > 2 * far ? Math.round(2 * x) / 2 : x;
        if (at === pixel) { low = Math.min(low, y); high = Math.max(high, y); last = y; } else { flush(); pixel = at; first = low = high = last = y; }
        before = [x, y];
      }
      flush();
      return parts.join("");
    }
    series(parent, frame, series, svg) {
      const { panel } = frame, px = (v) => bound(frame.px(place(panel.x, v))), py = (v) => bound(frame.py(place(panel.y, v)));
      if (series.kind === "line") {
        const [xs, ys] = this.points(series);
        make("path", { d: this.path(frame, xs, ys) || "M0 0", fill: "none", stroke: paint(series.color), "stroke-opacity": faint(series.color), "stroke-width": series.width, "stroke-dasharray": series.dash ? series.dash.join(" ") : "none", "stroke-linejoin": "round" }, parent);
      } else if (series.kind === "band") {
        const outline = [], [xs, ys] = this.points(series), [us, vs] = this.points(series, "upper");
        const clamp = (y) => Math.max(-9e3, Math.min(9e3, y)).toFixed(1), add = (x, y) => { if (isFinite(x) && isFinite(y)) outline.push(Math.max(-9e4, Math.min(9e4, px(x))).toFixed(1) + " " + clamp(py(y))); };
        for (let i = 0; i < xs.length; i++) add(xs[i], ys[i]);
        for (let i = us.length - 1; i >= 0; i--) add(us[i], vs[i]);
        if (outline.length) make("path", { d: "M" + outline.join("L") + "z", fill: paint(series.color), "fill-opacity": faint(series.color, series.opacity) }, parent);
      } else if (series.kind === "dots") {
        const [xs, ys] = this.points(series), parts = [];
        for (let i = 0; i < xs.length; i++) if (isFinite(xs[i]) && isFinite(ys[i])) parts.push("M" + px(xs[i]).toFixed(1) + " " + py(ys[i]).toFixed(1) + "h0");
        make("path", { d: parts.join(""), stroke: paint(series.color), "stroke-opacity": series.opacity, "stroke-width": 2 * series.radius, "stroke-linecap": "round" }, parent);
      } else if (series.kind === "marks") {
        const [xs, ys] = this.points(series);
        const within = (x, y) => x >= frame.left - 6 && x <= frame.right + 6 && y >= frame.top - 6 && y <= frame.bottom + 6;
        for (let i = 0; i < xs.length; i++) {
          const clampX = Math.max(panel.x.ends[0], Math.min(panel.x.ends[1], place(panel.x, xs[i]))), clampY = Math.max(panel.y.ends[0], Math.min(panel.y.ends[1], place(panel.y, ys[i])));
          if (isFinite(xs[i]) && isFinite(ys[i]) && within(frame.px(clampX), frame.py(clampY))) sign(series, frame.px(clampX), frame.py(clampY), svg);
        }
      } else if (series.kind === "texts") {
        const anchor = { Left: "start", Middle: "middle", Right: "end", Below: "middle", Upwards: "middle" }[series.anchor];
        for (const [[x, y], text] of series.texts) {
          const room = series.anchor === "Left" ? this.width - px(x) - 2 : 400;
          wrapped(text, room).forEach((line, i) => make("text", { x: px(x), y: py(y) + 4 + 13 * i, "text-anchor": anchor, fill: paint(series.color) }, svg, line));
        }
      } else this.cells(parent, svg, frame, series);
    }
    cells(parent, svg, frame, series) {
      const across = series.across.length - 1, span = series.axis.ends[1] - series.axis.ends[0];
      series.values.forEach((v, at) => {
        if (v === null) return;
        const row = Math.floor(at / across), col = at % across;
        const x = Math.floor(frame.px(series.across[col])), y = Math.floor(frame.py(series.upwards[row + 1]));
        make("rect", { x, y, width: Math.ceil(frame.px(series.across[col + 1])) - x, height: Math.ceil(frame.py(series.upwards[row])) - y, fill: heat((v - series.axis.ends[0]) / span) }, parent);
      });
      const x = frame.right + 14, tall = frame.bottom - frame.top;
      for (let i = 0; i < 40; i++) make("rect", { x, y: frame.bottom - (tall * (i + 1)) / 40, width: 12, height: tall / 40 + 0.6, fill: heat((i + 0.5) / 40) }, svg);
      const level = (v) => frame.bottom - (tall * (v - series.axis.ends[0])) / span;
      for (const [v, text] of series.ticks) make("text", { x: x + 16, y: level(v) + 4 }, svg, text);
      make("text", { x: x + 58, y: frame.top - 8, "text-anchor": "end" }, svg, series.axis.label);
      make("path", { d: signs.right, transform: `translate(${x - 5} ${level(series.marked[0])})`, fill: "var(--ink)" }, svg);
      make("text", { x: x + 2, y: frame.bottom + 16 }, svg, "▸ " + series.marked[1]);
    }

    // What stands under the pointer, or at the keyboard's cursor.
    listen() {
      let down = null, box = null;
      const at = (event) => {
        const frame = this.frames[event.target.dataset.at], bounds = this.svg.getBoundingClientRect();
        return { frame, x: event.clientX - bounds.left, y: event.clientY - bounds.top };
      };
      for (const hit of this.svg.querySelectorAll(".hit")) {
        hit.addEventListener("pointermove", (event) => {
          const { frame, x, y } = at(event);
          if (down && down.frame === frame && Math.abs(x - down.x) + Math.abs(y - down.y) > 5) {
            if (!box) box = make("rect", { class: "box" }, this.svg);
            const tall = Math.abs(y - down.y) > 20;
            const [a, b] = [Math.min(x, down.x), Math.max(x, down.x)].map((v) => Math.max(frame.left, Math.min(frame.right, v)));
            const [c, d] = tall ? [Math.min(y, down.y), Math.max(y, down.y)].map((v) => Math.max(frame.top, Math.min(frame.bottom, v))) : [frame.top, frame.bottom];
            for (const [key, v] of Object.entries({ x: a, y: c, width: b - a, height: d - c })) box.setAttribute(key, v);
            box.zoom = { x: b - a > 5 ? [frame.fx(a), frame.fx(b)] : null, y: tall && !frame.panel.y.texts ? [frame.fy(d), frame.fy(c)] : null };
          } else this.show(frame, x, y);
        });
        hit.addEventListener("pointerdown", (event) => {
          if (event.button) return;
          down = at(event);
          if (event.pointerType === "mouse") hit.setPointerCapture(event.pointerId);
        });
        hit.addEventListener("pointerup", (event) => {
          const { frame, x, y } = at(event), zoom = box && box.zoom;
          if (box) box.remove();
          if (down && zoom && (zoom.x || zoom.y)) this.zoom(frame.panel, zoom.x, zoom.y);
          else if (down) this.open(frame, x, y);
          down = box = null;
        });
        hit.addEventListener("pointercancel", () => { if (box) box.remove(); down = box = null; });
        hit.addEventListener("pointerleave", () => this.hide());
        hit.addEventListener("dblclick", () => this.unzoom());
      }
      this.svg.addEventListener("keydown", (event) => this.key(event));
      this.svg.addEventListener("blur", () => this.hide());
    }
    hide() {
      this.tip.hidden = true;
      for (const plot of plots) for (const frame of plot.frames || []) frame.over.textContent = "";
    }
    cell(frame, x, y) {
      const series = frame.panel.series.find((series) => series.kind === "cells");
      if (!series) return null;
      const find = (edges, p) => edges.findIndex((edge, i) => i + 1 < edges.length && p >= edge && p < edges[i + 1]);
      const col = find(series.across, frame.fx(x)), row = find(series.upwards, frame.fy(y));
      const index = row * (series.across.length - 1) + col;
      return row < 0 || col < 0 || series.values[index] === null ? null : { series, row, col, index, value: series.values[index] };
    }
    show(frame, x, y, speak = false) {
      this.hide();
      this.cursor = { frame: this.frames.indexOf(frame), x, y };
      const { panel } = frame, rows = [];
      const at = value(panel.x, frame.fx(x)), cell = this.cell(frame, x, y);
      let head = this.option ? this.option.dataset.option : "", anchor = x;
      if (cell) {
        const middle = (edges, i, axis) => shown(value(axis, (edges[i] + edges[i + 1]) / 2), 3);
        head = cell.series.axis.label + ": " + shown(cell.value, 3);
        rows.push(["", panel.x.label, middle(cell.series.across, cell.col, panel.x)], ["", panel.y.label || "speed", middle(cell.series.upwards, cell.row, panel.y)]);
        if (cell.series.stretches[cell.index].length) rows.push(["", "click", "show its samples"]);
      } else if (panel.y.texts) {
        const v = frame.fy(y), row = panel.y.texts.reduce((a, b) => (Math.abs(b[0] - v) < Math.abs(a[0] - v) ? b : a));
        const text = panel.beside.find((one) => Math.abs(one[0] - row[0]) < 0.3);
        head = row[1];
        if (text) rows.push(["", "", text[1]]);
      } else {
        let near = null;
        for (const series of panel.series) {
          if (this.hidden.has(series.name) || !series.points || series.kind === "dots") continue;
          if (!series.name && series.kind !== "marks" && panel.series.some((other) => other.name)) continue;
          const [xs, ys] = this.points(series);
          let best = -1, far = series.kind === "marks" ? 26 : 14;
          for (let i = 0; i < xs.length; i++) {
            const dx = Math.abs(frame.px(place(panel.x, xs[i])) - x);
            const away = series.kind === "marks" ? Math.hypot(dx, frame.py(place(panel.y, ys[i])) - y) : dx;
            if (away < far) { far = away; best = i; }
          }
          if (best < 0 || !isFinite(ys[best])) continue;
          if (series.kind === "marks" && (!near || far < near)) { near = far; anchor = frame.px(place(panel.x, xs[best])); }
          let text = shown(ys[best]);
          if (series.kind === "band") {
            const vs = this.points(series, "upper")[1];
            text += " … " + shown(vs[Math.min(best, vs.length - 1)]);
          }
          rows.push([series.color, series.name || panel.y.label, text]);
        }
        if (panel.x.label || panel.x.hidden) rows.unshift(["", panel.x.label || "time (s)", shown(value(panel.x, frame.fx(anchor)), 5)]);
      }
      const place_x = frame.fx(anchor);
      for (const plot of plots) for (const other of plot.frames || []) {
        if (other !== frame && !(panel.link && other.panel.link === panel.link)) continue;
        const px = other.px(place_x);
        if (!panel.y.texts && !cell && px >= other.left && px <= other.right) make("path", { d: `M${px} ${other.top}V${other.bottom}`, class: "cross" }, other.over);
      }
      if (!rows.length && !head) return;
      this.tip.textContent = "";
      if (head) html("b", "", this.tip, head);
      for (const [color, name, text] of rows) {
        const line = html("div", "", this.tip);
        const dot = html("i", "", line);
        dot.style.background = color ? paint(color) : "transparent";
        html("span", "", line, name);
        html("em", "", line, text);
      }
      this.tip.hidden = false;
      const bounds = this.svg.getBoundingClientRect(), home = this.room.getBoundingClientRect();
      const left = bounds.left - home.left + x, room = this.room.clientWidth;
      this.tip.style.left = Math.max(0, left + 14 + this.tip.offsetWidth > room ? left - 14 - this.tip.offsetWidth : left + 14) + "px";
      this.tip.style.top = bounds.top - home.top + y + 14 + "px";
      if (speak) this.said.textContent = [head, ...rows.map((row) => row[1] + " " + row[2])].filter(Boolean).join(", ");
    }
    open(frame, x, y) {
      const cell = this.cell(frame, x, y);
      const stretches = cell ? cell.series.stretches[cell.index] : [];
      if (!stretches.length) return;
      const choice = document.querySelector(".choice");
      if (!choice) return;
      const [trial] = stretches[0];
      const options = [...choice.querySelectorAll("[data-option]")];
      if (!options[trial]) return;
      let link = null;
      const mine = stretches.filter((one) => one[0] === trial).map((one) => [one[1], one[2]]);
      unfold(choice);
      select(choice, trial, (plot) => { link = link || plot.panels.map((panel) => panel.link).find(Boolean); });
      if (link) {
        const [from, to] = mine[0], margin = Math.max(1, 4 * (to - from));
        const ends = plots.flatMap((plot) => plot.panels).find((panel) => panel.link === link).x.ends;
        state.marks.set(link, mine);
        state.zoom.set(link, [Math.max(ends[0], from - margin), Math.min(ends[1], to + margin)]);
        redraw(new Set([link]), null);
        remember(link);
      }
      choice.scrollIntoView({ block: "start" });
    }
    key(event) {
      const cursor = this.cursor || { frame: 0, x: (this.frames[0].left + this.frames[0].right) / 2, y: (this.frames[0].top + this.frames[0].bottom) / 2 };
      const frame = this.frames[cursor.frame] || this.frames[0];
      const step = (event.shiftKey ? 0.1 : 0.02) * (frame.right - frame.left), rise = frame.panel.y.texts ? (frame.bottom - frame.top) / frame.panel.y.texts.length : 0.05 * (frame.bottom - frame.top);
      const move = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -rise], ArrowDown: [0, rise] }[event.key];
      const { x } = this.ends(frame.panel), p = frame.fx(cursor.x);
      if (move) {
        const hold = (v, low, high) => Math.max(low + 1, Math.min(high - 1, v));
        let next = cursor.frame, y = cursor.y + move[1];
        if (y > frame.bottom && this.frames[next + 1]) { next += 1; y = this.frames[next].top + 1; }
        if (y < frame.top && this.frames[next - 1]) { next -= 1; y = this.frames[next].bottom - 1; }
        const to = this.frames[next];
        this.show(to, hold(cursor.x + move[0], to.left, to.right), hold(y, to.top, to.bottom), true);
      } else if (event.key === "+" || event.key === "=") this.zoom(frame.panel, [p - 0.3 * (x[1] - x[0]), p + 0.3 * (x[1] - x[0])], null);
      else if (event.key === "-") {
        const whole = frame.panel.x.ends, half = (x[1] - x[0]) * 0.85;
        if (2 * half >= whole[1] - whole[0]) this.unzoom();
        else this.zoom(frame.panel, [Math.max(whole[0], p - half), Math.min(whole[1], p + half)], null);
      } else if (event.key === "Escape" || event.key === "0") this.unzoom();
      else if (event.key === "Enter") this.open(frame, cursor.x, cursor.y);
      else return;
      event.preventDefault();
      if (document.activeElement !== this.svg) this.svg.focus({ preventScroll: true });
    }
  }

  // The page ----------------------------------------------------------------------------------------------------------------
  const redraw = (links, also) => {
    for (const plot of plots) {
      if (plot !== also && !plot.panels.some((panel) => panel.link && links.has(panel.link))) continue;
      const focused = plot.svg && document.activeElement === plot.svg;
      if (plot.width) plot.draw();
      if (focused) plot.svg.focus({ preventScroll: true });
    }
  };
  const begin = (figure) => {
    let plot = plots.find((plot) => plot.figure === figure);
    if (!plot && data.figures[figure.dataset.figure]) { plot = new Plot(figure); plots.push(plot); }
    if (plot && !plot.width) plot.draw();
    return plot;
  };
  const unfold = (element) => {
    for (let up = element; up; up = up.parentElement) if (up.tagName === "DETAILS") up.open = true;
  };
  const select = (choice, at, each = () => {}) => {
    const options = [...choice.querySelectorAll("[data-option]")];
    options.forEach((option, i) => { option.hidden = i !== at; });
    const list = choice.querySelector("select");
    if (list) list.selectedIndex = at;
    for (const figure of options[at].querySelectorAll("figure[data-figure]")) { const plot = begin(figure); if (plot) each(plot); }
  };
  let quiet = false;
  const remember = (link) => {
    const option = [...document.querySelectorAll(".choice [data-option]")].find((option) => !option.hidden);
    const parts = option ? ["trial=" + encodeURIComponent(option.dataset.option)] : [];
    const zoom = link && state.zoom.get(link);
    if (zoom && option) parts.push("from=" + Number(zoom[0].toPrecision(6)), "to=" + Number(zoom[1].toPrecision(6)));
    quiet = true;
    if (parts.length) location.replace("#" + parts.join("&"));
  };
  const follow = () => {
    if (quiet) { quiet = false; return; }
    const hash = decodeURIComponent(location.hash.slice(1));
    const wanted = new URLSearchParams(location.hash.slice(1));
    if (wanted.get("trial")) {
      const choice = document.querySelector(".choice");
      const at = choice ? [...choice.querySelectorAll("[data-option]")].findIndex((option) => option.dataset.option === wanted.get("trial")) : -1;
      if (at < 0) return;
      unfold(choice);
      const links = new Set();
      select(choice, at, (plot) => plot.panels.forEach((panel) => panel.link && links.add(panel.link)));
      const [from, to] = [parseFloat(wanted.get("from")), parseFloat(wanted.get("to"))];
      if (to > from) { links.forEach((link) => state.zoom.set(link, [from, to])); redraw(links, null); }
      choice.scrollIntoView({ block: "start" });
    } else if (hash) {
      const target = document.getElementById(hash);
      if (!target) return;
      unfold(target);
      const option = target.closest("[data-option]");
      if (option) select(option.closest(".choice"), [...option.parentElement.querySelectorAll("[data-option]")].indexOf(option));
      target.querySelectorAll("figure[data-figure]").forEach(begin);
      target.scrollIntoView({ block: "start" });
    }
  };
  // The first place of each of the glossary's terms says on hovering what it means.
  const explain = () => {
    const meanings = new Map([...document.querySelectorAll("#s-terms dt")].map((term) => [term.textContent.toLowerCase(), term.nextElementSibling.textContent]));
    if (!meanings.size) return;
    const terms = [...meanings.keys()].sort((a, b) => b.length - a.length).map((term) => term.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
    const wanted = new RegExp("(?<![\\p{L}\\p{N}_-])(" + terms.join("|") + ")(?=s?(?![\\p{L}\\p{N}_-]|\\.\\p{L}))", "giu");
    const walk = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT, (node) =>
      node.parentElement.closest("#s-terms, nav, thead, abbr, a, button, label, svg, h2, summary, dl.provenance, script, .picker") ? NodeFilter.FILTER_REJECT : NodeFilter.FILTER_ACCEPT);
    const nodes = [];
    while (walk.nextNode()) nodes.push(walk.currentNode);
    for (let node of nodes) {
      let from = 0;
      for (const found of [...node.textContent.matchAll(wanted)]) {
        const meaning = meanings.get(found[1].toLowerCase());
        if (!meaning) continue;
        meanings.delete(found[1].toLowerCase());
        const rest = node.splitText(found.index - from);
        from = found.index + found[1].length;
        node = rest.splitText(found[1].length);
        const mark = html("abbr", "term", null, rest.textContent);
        mark.title = meaning;
        rest.replaceWith(mark);
      }
    }
  };
  const number = (text) => {
    const found = /^[^0-9\u2212.-]*([\u2212-]?[0-9][0-9 \u00a0\u2009]*\.?[0-9]*(?:e[+-]?[0-9]+)?)/.exec(text.trim());
    if (!found) return null;
    const x = parseFloat(found[1].replace("\u2212", "-").replace(/[ \u00a0\u2009]/g, ""));
    return / mN\b|\u00a0mN\b/.test(text) ? x / 1e3 : x;
  };
  const sortable = (table) => {
    if (table.tBodies[0].rows.length < 2) return;
    [...table.tHead.rows[0].cells].forEach((head, at) => {
      if (!head.textContent.trim()) return;
      const button = html("button", "sort", null, head.textContent);
      button.type = "button";
      head.textContent = "";
      head.appendChild(button);
      button.addEventListener("click", () => {
        const down = head.getAttribute("aria-sort") !== "ascending";
        for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", down ? "ascending" : "descending");
        const rows = [...table.tBodies[0].rows], key = (row) => row.cells[at].textContent;
        const numbers = rows.every((row) => number(key(row)) !== null || /^[–\s]*$/.test(key(row)));
        const order = (a, b) => (numbers ? (number(key(a)) ?? -1e300) - (number(key(b)) ?? -1e300) : key(a).localeCompare(key(b), "en", { numeric: true }));
        rows.sort((a, b) => (down ? 1 : -1) * order(a, b)).forEach((row) => table.tBodies[0].appendChild(row));
      });
    });
  };
  const read = async () => {
    const text = document.getElementById("data").textContent.trim().replace(/-/g, "+").replace(/_/g, "/");
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    return JSON.parse(await new Response(stream).text());
  };
  const start = async () => {
    if (!window.DecompressionStream) throw new Error("this browser cannot unpack the figures' data");
    data = await read();
    document.documentElement.classList.add("live");
    explain();
    document.querySelectorAll("table").forEach(sortable);
    for (const choice of document.querySelectorAll(".choice")) {
      const options = [...choice.querySelectorAll("[data-option]")], bar = html("div", "picker");
      const label = html("label", "", bar, choice.dataset.label + " ");
      const list = html("select", "", label);
      options.forEach((option) => html("option", "", list, option.dataset.option));
      for (const [text, by] of [["‹", -1], ["›", 1]]) {
        const button = html("button", "", bar, text);
        button.type = "button";
        button.setAttribute("aria-label", by < 0 ? "previous" : "next");
        button.addEventListener("click", () => { select(choice, (list.selectedIndex + by + options.length) % options.length); remember(null); });
      }
      list.addEventListener("change", () => { select(choice, list.selectedIndex); remember(null); });
      choice.prepend(bar);
      options.forEach((option, i) => { option.hidden = i > 0; });
    }
    const seen = new IntersectionObserver((entries) => entries.forEach((entry) => entry.isIntersecting && begin(entry.target)), { rootMargin: "600px" });
    document.querySelectorAll("figure[data-figure]").forEach((figure) => seen.observe(figure));
    let wait = 0;
    addEventListener("resize", () => { clearTimeout(wait); wait = setTimeout(() => plots.forEach((plot) => plot.room.clientWidth && plot.room.clientWidth !== plot.width && plot.draw()), 80); });
    addEventListener("beforeprint", () => {
      paper = document.documentElement.dataset.theme || "";
      if (isDark()) color("light");
      document.querySelectorAll("details").forEach((one) => { one.open = true; });
      document.querySelectorAll("figure[data-figure]").forEach(begin);
    });
    addEventListener("afterprint", () => color(paper));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolor);
    addEventListener("hashchange", follow);
    follow();
    document.documentElement.dataset.ready = "yes";
  };
  // Light or dark: what the system asks for (""), or what the reader chose; paper is light.
  let paper = "";
  const recolor = () => {
    dark = isDark();
    plots.forEach((plot) => plot.width && plot.panels.some((panel) => panel.series.some((one) => one.kind === "cells")) && plot.draw());
  };
  const color = (theme) => {
    if (theme) document.documentElement.dataset.theme = theme;
    else delete document.documentElement.dataset.theme;
    recolor();
  };
  const theme = document.getElementById("theme");
  theme.hidden = false;
  theme.addEventListener("click", () => color(isDark() ? "light" : "dark"));
  start().catch((error) => {
    // Without its data the page still has its text; say what happened where the figures would be.
    document.querySelectorAll("figure .plot").forEach((room) => { room.textContent = "This figure could not be drawn (" + error.message + "); it is in the folder plots beside this page."; });
  });
})();
