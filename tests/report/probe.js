// What a reader of the page sees, as JSON in an element of its own. Run by report_test.py behind the page's own script.
(() => {
  const row_of = (element) => element.closest("[data-row]")?.getAttribute("data-row") ?? null;
  const shown = (element) => {
    const box = element.getBoundingClientRect();
    return [box.left, box.top, box.right, box.bottom];
  };
  const loose = [];
  document.querySelectorAll("details").forEach((details) => { details.open = true; });
  const texts = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const element = texts.currentNode.parentElement;
    if (/\d/.test(texts.currentNode.data) && row_of(element) === null && !element.closest(".axis, .number, title"))
      loose.push(texts.currentNode.data.trim());
  }
  const probe = {
    drawn: document.body.getAttribute("data-drawn"),
    window_width: window.innerWidth,
    client_width: document.documentElement.clientWidth,
    scroll_width: document.documentElement.scrollWidth,
    paper: getComputedStyle(document.body).backgroundColor,
    loose,
    figures: [...document.querySelectorAll(".figure")].map((e) => ({
      row: row_of(e), text: e.textContent, unit: e.nextElementSibling?.textContent ?? "", box: shown(e)})),
    words: [...document.querySelectorAll("[data-row]:not(.figure):not(path)")].map((e) => ({
      row: row_of(e), text: e.textContent, box: shown(e), in_verdict: e.closest("#verdict") !== null,
      colour: getComputedStyle(e.parentElement).backgroundColor})),
    first_case: document.querySelector("#stability tbody th")?.textContent ?? "",
    chips: [...document.querySelectorAll("[data-verdict-row]")].map((e) => ({
      row: e.getAttribute("data-verdict-row"), classes: e.getAttribute("class"), colour: getComputedStyle(e).backgroundColor})),
    fronts: [...document.querySelectorAll(".pareto li")].map((e) => e.textContent),
    plots: [...document.querySelectorAll("svg.plot")].map((e) => ({
      id: e.dataset.plot, x: e.dataset.x, y: e.dataset.y, box: shown(e),
      paths: [...e.querySelectorAll("path[data-row]")].map((p) => ({row: row_of(p), d: p.getAttribute("d")})),
      points: [...e.querySelectorAll(".point")].map((p) => ({
        x_row: p.dataset.xRow, y_row: p.dataset.yRow, at: p.querySelector("path").getAttribute("transform"),
        box: shown(p.querySelector("path")), bars: p.querySelectorAll(".bar").length}))})),
  };
  const pre = document.createElement("pre");
  pre.id = "probe";
  pre.textContent = JSON.stringify(probe);
  document.body.append(pre);
})();
