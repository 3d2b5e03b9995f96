"use strict";

// The page is made of the rows of report.csv and of nothing else. Whatever shows a figure carries data-row, the number of its row
// (the first below the header is 0).
const rows = d3.csv.parse(report_csv);
rows.forEach((row, i) => { row.index = i; });

const pick = (wanted) => rows.filter((row) => Object.keys(wanted).every((key) => row[key] === wanted[key]));
const one = (wanted) => pick(wanted)[0];
const unique = (list) => [...new Set(list)];
const symbols = {};
pick({section: "form", metric: "symbol"}).forEach((row) => { symbols[row.quantity] = row.value; });
const spoken = (name) => (name === "all" ? "all together" : name.replace(/_/g, " "));
const short = (name) => symbols[name] || spoken(name);

// Three digits at most; whole numbers below a million whole.
function rounded(text) {
  const x = Number(text);
  if (!Number.isFinite(x)) return text === "inf" ? "∞" : text;
  if (Number.isInteger(x) && Math.abs(x) < 1e6) return String(x);
  if (Math.abs(x) >= 1e6 || Math.abs(x) < 1e-3) return x.toExponential(1);
  return String(Number(x.toPrecision(3)));
}

// Nanoseconds with four digits before the point are microseconds, where the unit stands beside them.
function figure(parent, row, unit = row.unit) {
  const long = unit === "ns" && Number(row.value) >= 999.5;
  const span = parent.append("span").attr("class", "figure").attr("data-row", row.index)
    .text(rounded(long ? String(Number(row.value) / 1000) : row.value));
  if (unit && unit !== "1") parent.append("span").text(" " + (long ? "µs" : unit));
  return span;
}
const word = (parent, row) => parent.append("span").attr("data-row", row.index).text(row.value);

function heading() {
  const about = {};
  pick({section: "robot"}).forEach((row) => { about[row.metric] = row; });
  d3.select("h1").append("span").attr("data-row", about.base.index).text(about.base.case);
  const verdict = d3.select("#verdict"), of_quantities = pick({section: "verdict", metric: "of_a_quantity"});
  pick({section: "verdict"}).filter((row) => !of_quantities.includes(row))
    .forEach((row) => word(verdict.append("p").attr("class", row.metric), row));
  const each = verdict.append("details");
  each.append("summary").text("Quantity by quantity");
  of_quantities.forEach((row) => word(each.append("p"), row));
  const p = d3.select("#about p");
  word(p, about.base);
  p.append("span").text(" base, ");
  figure(p, about.joints);
  p.append("span").text(", ");
  figure(p, about.mass);
  p.append("span").text(". Compared with ");
  word(p, about.compared_with);
  p.append("span").text(". ");
  word(p, about.processor);
  p.append("span").text(", ");
  figure(p, about.cores);
  p.append("span").text("; flags ");
  word(p, about.flags);
  p.append("span").text("; code made by ");
  word(p.append("code"), about.command);
  p.append("span").text("; ");
  word(p, about.date);
  p.append("span").text(", ");
  word(p, about.mode);
  p.append("span").text(" report.");
}

// A diagram with two logarithmic axes. Points: {x, y: rows; x_bar, y_bar: rows of the ends of their bars; mark, classes, name;
// number where there is one}. Lines: {points, classes}. Values of zero stand on the lower edge.
function log_plot(parent, id, x_label, y_label, points, lines) {
  const width = 360, height = 290, margin = {left: 46, right: 14, top: 24, bottom: 36};
  const value = (row) => Number(row.value);
  const extent = (lists) => d3.extent(d3.merge(lists).map(value).filter((v) => v > 0 && Number.isFinite(v)));
  const [x_low, x_high] = extent(points.map((p) => [p.x, ...p.x_bar]));
  const [y_low, y_high] = extent(points.map((p) => [p.y, ...p.y_bar]));
  const domain = {x: [x_low / 1.3, x_high * 1.3], y: y_low ? [y_low / 4, y_high * 3] : [1e-17, 1e-15]};
  const x = d3.scale.log().domain(domain.x).range([margin.left, width - margin.right]);
  const y = d3.scale.log().domain(domain.y).range([height - margin.bottom, margin.top]).clamp(true);
  const at_y = (row) => y(Math.max(value(row), domain.y[0]));
  const svg = parent.append("svg").attr("viewBox", `0 0 ${width} ${height}`).attr("class", "plot diagram").attr("role", "img")
    .attr("aria-label", id).attr("data-plot", id).attr("data-x", x.domain().concat(x.range()).join(" "))
    .attr("data-y", y.domain().concat(y.range()).join(" "));

  const decades = (scale, most) => {
    const [low, high] = scale.domain().map(Math.log10);
    const step = Math.max(1, Math.ceil((high - low) / most));
    const ticks = d3.range(Math.ceil(low), Math.floor(high) + 1, step).map((k) => Number(`1e${k}`));
    return ticks.length > 1 ? ticks : scale.ticks().filter((v, i, all) => i % Math.ceil(all.length / 4) === 0);
  };
  const tick = (v) => (Math.log10(v) % 1 === 0 && (v >= 1e4 || v < 1e-2) ? "1e" + Math.log10(v) : String(v));
  const axis = (scale, orient, most) =>
    d3.svg.axis().scale(scale).orient(orient).tickValues(decades(scale, most)).tickFormat(tick).outerTickSize(0);
  svg.append("g").attr("class", "axis").attr("transform", `translate(0,${height - margin.bottom})`).call(axis(x, "bottom", 6));
  svg.append("g").attr("class", "axis").attr("transform", `translate(${margin.left},0)`).call(axis(y, "left", 7));
  svg.append("text").attr("x", width - margin.right).attr("y", height - 4).attr("text-anchor", "end").text(x_label);
  svg.append("text").attr("x", 4).attr("y", 8).attr("dy", "0.3em").text(y_label);

  const path = d3.svg.line().x((p) => x(value(p.x))).y((p) => at_y(p.y));
  lines.forEach((line) => svg.append("path").attr("class", line.classes).attr("d", path(line.points)));
  points.forEach((p) => {
    const g = svg.append("g").attr("class", "point " + p.classes).attr("data-x-row", p.x.index).attr("data-y-row", p.y.index);
    const px = x(value(p.x)), py = at_y(p.y);
    g.append("title").text(`${p.name}: ${rounded(p.x.value)} ${p.x.unit}, ${rounded(p.y.value)}`);
    if (p.x_bar.length) {
      const [from, to] = p.x_bar.map((row) => x(value(row)));
      g.append("line").attr("class", "bar").attr("x1", from).attr("x2", to).attr("y1", py).attr("y2", py);
    }
    if (p.y_bar.length) {
      const [from, to] = d3.extent(p.y_bar.map(at_y));
      g.append("line").attr("class", "bar").attr("x1", px).attr("x2", px).attr("y1", from).attr("y2", to);
    }
    g.append("path").attr("d", d3.svg.symbol().type(p.mark).size(38)()).attr("transform", `translate(${px},${py})`);
    if (p.number) g.append("text").attr("class", "number").attr("x", px + 6).attr("y", py - 6).text(p.number);
  });
}

function table(parent, titles) {
  const t = parent.append("table");
  const head = t.append("thead").append("tr");
  titles.forEach((title, i) => head.append("th").attr("class", i ? "number" : "").text(title));
  return t.append("tbody");
}

// Who has no point there, and why.
function left_out(box, list) {
  list.filter((r) => r.metric === "left_out").forEach((row) => {
    const line = box.append("p").attr("class", "left_out");
    line.append("span").attr("data-row", row.index).text(row.variant);
    line.append("span").text(": ");
    word(line, row);
  });
}

function rounding() {
  const all = pick({section: "rounding"});
  const by_quantity = d3.nest().key((r) => r.quantity).map(all);
  const together = pick({section: "rounding", quantity: "all", metric: "time_median"});
  Object.keys(by_quantity).filter((quantity) => quantity !== "all").forEach((quantity) => {
    const by_variant = d3.nest().key((r) => r.variant)
      .map(by_quantity[quantity].filter((r) => r.metric !== "chosen" && r.metric !== "left_out"));
    const points = Object.keys(by_variant).map((variant) => {
      const of = {};
      by_variant[variant].forEach((row) => { of[row.metric] = row; });
      const other = variant.startsWith("generic") ? "generic" : {MuJoCo: "mujoco", Pinocchio: "pinocchio"}[variant] || "";
      return {
        x: of.time_median, x_bar: [of.time_lower_quartile, of.time_upper_quartile], y: of.norm_worst,
        y_bar: [of.norm_median, of.norm_worst], name: variant, of,
        mark: {generic: "diamond", mujoco: "triangle-up", pinocchio: "triangle-down"}[other] || (variant.startsWith("rolled") ? "square" : "circle"),
        classes: (other || (variant.includes("float") ? "float" : "double")) +
          (variant.includes("not fused") ? " hollow" : ""),
      };
    });
    const front = points.filter((p) => p.of.pareto.value === "1").sort((a, b) => a.x.value - b.x.value);
    front.forEach((p, i) => { p.number = i + 1; });
    const box = d3.select("#rounding .plots").append("figure");
    box.append("h3").text(`${spoken(quantity)} ${symbols[quantity] || ""}`);
    log_plot(box, `rounding ${quantity}`, "time of a call, ns", "relative error, worst", points,
      [{points: front, classes: "front"}]);
    const caption = box.append("figcaption").append("ol").attr("class", "pareto");
    front.forEach((p) => {
      const item = caption.append("li");
      item.append("span").attr("data-row", p.of.pareto.index).text(p.name);
      item.append("span").text(": ");
      figure(item, p.x);
      item.append("span").text(", ");
      figure(item, p.of.ulp_worst);
    });
    left_out(box, by_quantity[quantity]);
    const details = box.append("details");
    details.append("summary").text("all figures");
    const body = table(details, ["variant", "ns", "ulp, worst", "ulp, median", "by element"]);
    points.forEach((p) => {
      const tr = body.append("tr");
      tr.append("td").attr("data-row", p.x.index).text(p.name);
      [p.x, p.of.ulp_worst, p.of.ulp_median, p.of.component_worst].forEach((row) =>
        figure(tr.append("td").attr("class", "number"), row, ""));
    });
  });
  if (together.length) {
    const box = d3.select("#rounding .plots").append("figure");
    box.append("h3").text("all together");
    const body = table(box, ["variant", "ns"]);
    together.forEach((row) => {
      const tr = body.append("tr");
      tr.append("td").attr("data-row", row.index).text(row.variant);
      figure(tr.append("td").attr("class", "number"), row, "");
    });
    left_out(box, by_quantity.all);
    pick({section: "rounding", quantity: "all", metric: "elements_changed"}).forEach((row) => {
      const line = box.append("p").attr("class", "left_out");
      line.append("span").attr("data-row", row.index).text(row.variant);
      line.append("span").text(": results differ from those in one thread in ");
      figure(line, row);
    });
  }
}

// Whose figure is not in ulp says what it counts.
const counted = {elements_changed: "changed", change: "change", elements_not_finite: "not finite"};

// A matrix for code in double and one for float: cases from the worst to the best, a column per quantity.
function stability() {
  const all = pick({section: "stability"});
  const in_words = ["verdict", "violated", "ulp_allowed", "times_allowed", "largest_change"];  // the last are in the words of `violated`
  const by_case = d3.nest().key((r) => r.variant).key((r) => r.case).key((r) => r.quantity).map(all);
  const quantities = unique(all.map((r) => r.quantity));
  all.filter((r) => r.metric === "violated").forEach((row) => {
    const why = d3.select("#stability .violations").append("p").attr("class", "violated");
    [row.variant, ", ", row.case, ", "].forEach((text, i) => (i % 2 ? why.append("span").text(text) : word(why, {index: row.index, value: text})));
    why.append("span").attr("data-row", row.index).text(short(row.quantity));
    why.append("span").text(": ");
    word(why, row);
  });
  const rank = {bad: 0, weak: 1, good: 2};
  unique(all.map((r) => r.variant)).forEach((variant) => {
    const box = d3.select("#stability .cases").append("div").attr("class", "matrix");
    const body = table(box, [""].concat(quantities.map(short)));
    word(box.select("thead th").attr("class", ""), {index: all.find((r) => r.variant === variant).index, value: variant});
    const cases = Object.keys(by_case[variant]).map((name, order) => {
      const verdicts = d3.merge(Object.values(by_case[variant][name])).filter((r) => r.metric === "verdict");
      return {name, order, worst: d3.min(verdicts, (r) => rank[r.value])};
    }).sort((one, other) => one.worst - other.worst || one.order - other.order);
    cases.forEach((one) => {
      const cells = by_case[variant][one.name], tr = body.append("tr").attr("class", one.worst === 0 ? "has_bad" : "");
      const any = Object.values(cells)[0][0];
      tr.append("th").attr("scope", "row").attr("data-row", any.index).text(one.name);
      quantities.forEach((quantity) => {
        const td = tr.append("td"), own = cells[quantity] || [];
        const row = own.find((r) => !in_words.includes(r.metric)), verdict = own.find((r) => r.metric === "verdict");
        if (!row) return;
        const chip = td.append("span").attr("class", "chip " + verdict.value).attr("data-verdict-row", verdict.index);
        figure(chip, row, "");
        if (row.unit !== "ulp") chip.append("span").text(" " + counted[row.metric]);
      });
    });
  });
}

function free_motion(section, all) {
  const looks = {"semi-implicit Euler": ["euler", "circle"], "RK4": ["rk4", "square"], "implicit midpoint": ["midpoint", "diamond"],
    "linearly implicit": ["linear", "triangle-up"]};
  const points = all.filter((r) => r.metric === "error" && Number.isFinite(Number(r.value))).map((row) => ({
    x: all.find((r) => r.metric === "time" && r.case === row.case && r.variant === row.variant), x_bar: [], y: row, y_bar: [],
    name: `${row.variant}, ${row.case}`, variant: row.variant, mark: looks[row.variant][1], classes: looks[row.variant][0]}));
  const box = section.select(".plots").append("figure");
  box.append("h3").text("state, free motion");
  log_plot(box, "integration", "s of computing per s of motion", "error of q and v", points, Object.keys(looks).map((variant) => (
    {points: points.filter((p) => p.variant === variant), classes: "curve " + looks[variant][0]})));
  const details = box.append("details");
  details.append("summary").text("all figures");
  const body = table(details, ["integrator and step", "error", "s per s", "energy drift"]);
  points.forEach((p) => {
    const tr = body.append("tr");
    const name = tr.append("td");
    name.append("span").attr("data-row", p.y.index).text(p.variant);
    name.append("span").text(", ");
    name.append("span").attr("data-row", p.y.index).text(p.y.case);
    const drift = all.find((r) => r.metric === "energy_drift" && r.case === p.y.case && r.variant === p.variant);
    [p.y, p.x, drift].forEach((row) => figure(tr.append("td").attr("class", "number"), row, ""));
  });
  const orders = section.select(".orders");
  orders.append("span").text("Orders seen:");
  all.filter((r) => r.metric === "order").forEach((row) => {
    orders.append("span").text(" ");
    word(orders, {index: row.index, value: row.variant});
    orders.append("span").text(" ");
    figure(orders, row, "");
    orders.append("span").text(";");
  });
}

function integration() {
  const all = pick({section: "integration"});
  const none = all.find((r) => r.metric === "not_simulated");
  const section = d3.select("#integration");
  if (none && !none.case) {
    section.selectAll("p, h3, div").remove();
    const p = section.append("p");
    p.append("span").text("Not simulated: ");
    word(p, none);
    return;
  }
  if (none) {
    const p = section.select(".plots").append("p");
    p.append("span").text("Not simulated: ");
    word(p, none);
  } else {
    free_motion(section, all);
  }
  unique(all.filter((r) => r.metric === "largest_speed").map((r) => r.case)).forEach((name) => {
    const line = section.select(".springs").append("p");
    line.append("span").attr("data-row", all.find((r) => r.case === name).index).text(name);
    line.append("span").text(" ");
    all.filter((r) => r.case === name && r.metric === "largest_speed").forEach((row) => {
      const verdict = all.find((r) => r.case === name && r.variant === row.variant && r.metric === "verdict");
      const chip = line.append("span").attr("class", "chip " + verdict.value).attr("data-verdict-row", verdict.index);
      chip.append("span").attr("data-row", row.index).text(row.variant);
      chip.append("span").text(" ");
      figure(chip, row, "");
    });
  });
  const steps = all.filter((r) => r.metric === "largest_stable_step");
  const rows_of_steps = table(section.select(".steps"), ["largest stable step, s"]);
  const head = section.select(".steps thead tr");
  unique(steps.map((r) => r.case)).forEach((name) => {
    word(head.append("th").attr("class", "number"), {index: steps.find((r) => r.case === name).index, value: name});
  });
  unique(steps.map((r) => r.variant)).forEach((variant) => {
    const own = steps.filter((r) => r.variant === variant), tr = rows_of_steps.append("tr");
    word(tr.append("td"), {index: own[0].index, value: variant});
    own.forEach((row) => figure(tr.append("td").attr("class", "number"), row, ""));
  });
}

function facts() {
  const box = d3.select("#forms .facts");
  const p = box.append("p");
  pick({section: "form", quantity: "all", metric: "form"}).forEach((row) => {
    p.append("span").attr("data-row", row.index).text(row.case);
    p.append("span").text(": ");
    word(p, row);
    p.append("span").text("; ");
  });
  p.append("span").text("workspace ");
  figure(p, one({section: "form", metric: "workspace"}));
  p.append("span").text(".");
  const branches = pick({section: "form", metric: "branches"});
  if (branches.length) {
    const body = table(box, ["segment", "branches side by side", "steps"]);
    branches.forEach((row) => {
      const tr = body.append("tr");
      tr.append("td").attr("data-row", row.index).text(row.case);
      figure(tr.append("td").attr("class", "number"), row, "");
      figure(tr.append("td").attr("class", "number"), one({section: "form", case: row.case, metric: "steps"}), "");
    });
  }
  const alone = pick({section: "form", case: "alone", metric: "form"});
  const list = box.append("ul");
  alone.forEach((row) => {
    const item = list.append("li");
    item.append("span").text(`${spoken(row.quantity)} alone: `);
    word(item, row);
  });
  const unread = box.append("details");
  unread.append("summary").text("What is not read, and what is not asked for");
  const lines = unread.append("ul");
  pick({section: "left_out"}).forEach((row) => {
    const item = lines.append("li");
    if (row.metric === "not_asked_for") {
      item.append("span").attr("data-row", row.index).text(row.quantity);
      item.append("span").text(" is not asked for");
    } else {
      item.append("span").text(row.quantity === "all" ? "not read at all: " : `not read by ${spoken(row.quantity)}: `);
      word(item, row);
    }
  });
}

function operations() {
  const all = pick({section: "operations"});
  const metrics = ["multiply", "add", "sincos", "divide"].filter((metric) => all.some((r) => r.metric === metric && r.value !== "0"));
  const body = table(d3.select("#forms .operations"), ["", ...metrics]);
  unique(all.map((r) => r.quantity)).forEach((quantity) => ["before", "here"].forEach((variant) => {
    const here = all.filter((r) => r.quantity === quantity && r.variant === variant);
    if (!here.length) return;
    const tr = body.append("tr");
    tr.append("td").text(`${short(quantity)}, ${variant}`);
    metrics.forEach((metric) => figure(tr.append("td").attr("class", "number"), here.find((r) => r.metric === metric), ""));
  }));
}

function sparsity() {
  unique(pick({section: "sparsity"}).map((r) => r.quantity)).forEach((quantity) => {
    const pattern = pick({section: "sparsity", quantity, metric: "pattern"});
    const n = pattern.length;
    const box = d3.select("#forms .plots").append("figure").attr("class", "sparsity");
    box.append("h3").text(`${spoken(quantity)} ${symbols[quantity] || ""}`);
    const svg = box.append("svg").attr("viewBox", `0 0 ${n} ${n}`).attr("class", "plot").attr("role", "img")
      .attr("aria-label", `sparsity ${quantity}`).attr("data-plot", `sparsity ${quantity}`);
    pattern.forEach((row, i) => ["x", "c"].forEach((kind) => {
      let d = "";
      for (const run of row.value.matchAll(new RegExp(`${kind}+`, "g"))) d += `M${run.index} ${i}h${run[0].length}v1h-${run[0].length}z`;
      if (d) svg.append("path").attr("class", kind).attr("data-row", row.index).attr("d", d);
    }));
    svg.append("rect").attr("class", "edge").attr("width", n).attr("height", n).attr("stroke-width", n / 200);
    const caption = box.append("figcaption");
    figure(caption, one({section: "sparsity", quantity, metric: "not_zero"}), "");
    caption.append("span").text(" of ");
    figure(caption, one({section: "sparsity", quantity, metric: "elements"}));
    caption.append("span").text(" are not zero, ");
    figure(caption, one({section: "sparsity", quantity, metric: "constant"}), "");
    caption.append("span").text(" of them constant");
  });
}

heading();
rounding();
stability();
integration();
facts();
operations();
sparsity();
document.body.setAttribute("data-drawn", "yes");
