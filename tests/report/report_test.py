#!/usr/bin/env python3
"""report_test.py DALEMBERT BROWSER ROBOT WORK FLAGS

Makes a quick report, with FLAGS besides the test's own, looks at its page in the browser at the width of a phone and of a desk,
in light and in dark, and compares what stands there with report.csv. Then spoils the page in several ways and sees that the
comparison finds each.
"""
import csv
import decimal
import html
import io
import json
import math
import os
import pathlib
import pty
import re
import shutil
import signal
import subprocess
import sys
import time

dalembert, browser, robot, work, flags = *sys.argv[1:4], pathlib.Path(sys.argv[4]), sys.argv[5]
probe_script = (pathlib.Path(__file__).parent / "probe.js").read_text()
columns = ["section", "case", "quantity", "variant", "metric", "value", "unit"]
os.environ["DALEMBERT_PINOCCHIO"] = "none"  # the same everywhere
quantities = ["coriolis_matrix", "gravity"]
command = [dalembert, "report", robot, "--base", "floating", "--outputs", ",".join(quantities), "--quick", "--damping", "a_02_joint=0.5",
           "--flags", f"-O1 -march=native -std=c++17 {flags}", "-o", str(work / "out")]


class Wrong(Exception):
    pass


def demand(condition, message):
    if not condition:
        raise Wrong(message)


def rounded(text):
    """As the page's script rounds."""
    x = float(text)
    if not math.isfinite(x):
        return "∞" if text == "inf" else text
    if x == int(x) and abs(x) < 1e6:
        return str(int(x))
    if abs(x) >= 1e6 or abs(x) < 1e-3:
        mantissa, exponent = f"{digits(x, 2):.1e}".split("e")
        return f"{mantissa}e{int(exponent):+d}"
    return re.sub(r"\.0$", "", str(float(digits(x, 3))))


def digits(x, count):
    """So many digits of a number; of two as near the larger, as JavaScript has it, not Python: 332.5 is 333."""
    exact = decimal.Decimal(x)
    return exact.quantize(decimal.Decimal(1).scaleb(exact.adjusted() - count + 1), decimal.ROUND_HALF_UP)


def look(page, width, scheme):
    """What the probe sees of the page."""
    probed = work / "probed.html"
    probed.write_text(page.replace("</body>", f"<script>{probe_script}</script></body>"))
    run = subprocess.run(
        [browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={work / 'profile'}",
         f"--window-size={width},900", f"--blink-settings=preferredColorScheme={1 if scheme == 'light' else 0}", "--dump-dom",
         probed.as_uri()], capture_output=True, text=True, timeout=120, check=True)
    found = re.search(r'<pre id="probe">(.*?)</pre>', run.stdout, re.DOTALL)
    demand(found, f"the browser shows no page: {run.stderr[-2000:]}")
    return json.loads(html.unescape(found.group(1)))


def read_rows(text):
    lines = list(csv.reader(io.StringIO(text)))
    demand(lines[0] == columns, f"the columns are {lines[0]}")
    for line in lines[1:]:
        demand(len(line) == len(columns), f"not {len(columns)} cells: {line}")
    return [dict(zip(columns, line)) for line in lines[1:]]


def check_rows(rows):
    sections = {row["section"] for row in rows}
    for wanted in ["robot", "form", "left_out", "operations", "sparsity", "rounding", "stability", "integration", "verdict"]:
        demand(wanted in sections, f"there is no section {wanted}")
    for row in rows:
        if row["unit"]:
            demand(row["value"] in ("inf", "nan") or math.isfinite(float(row["value"])), f"no number: {row}")
    for quantity in quantities:
        here = [row for row in rows if row["section"] == "rounding" and row["quantity"] == quantity]
        variants = {row["variant"] for row in here if row["metric"] != "left_out"}
        left_out = {row["variant"] for row in here if row["metric"] == "left_out"}
        demand(left_out == ({"MuJoCo"} if quantity == "coriolis_matrix" else set()), f"{quantity} is left out by {left_out}")
        # Of the form that was chosen there are more variants than of the other.
        def expected(chosen):
            return {"generic double", "straight double", "rolled double", f"{chosen} float", f"{chosen} double, not fused",
                    f"{chosen} double, library sines"} | {"MuJoCo"} - left_out

        demand(variants in (expected("straight"), expected("rolled")), f"{quantity} has {variants}")
        for variant in variants:
            value = {row["metric"]: float(row["value"]) for row in here if row["variant"] == variant and row["unit"]}
            demand(0 < value["time_lower_quartile"] <= value["time_median"] <= value["time_upper_quartile"], f"times: {value}")
            demand(0 <= value["norm_median"] <= value["norm_worst"] < (1e-5 if "float" in variant else 1e-13), f"errors: {value}")
            demand(0 <= value["ulp_worst"] < 100, f"ulp: {value}")
        demand(any(row["metric"] == "pareto" and row["value"] == "1" for row in here), f"{quantity} has no Pareto front")
        demand(any(row["section"] == "stability" and row["quantity"] == quantity and row["case"] == "base at 1e12 m" and
                   row["metric"] == "elements_changed" and row["value"] == "0" for row in rows),
               f"{quantity} changes with the base's position")
    check_others(rows)
    verdicts = {row["value"] for row in rows if row["section"] == "stability" and row["metric"] == "verdict"}
    demand(verdicts <= {"good", "weak", "bad"} and "good" in verdicts, f"verdicts {verdicts}")
    orders = {row["variant"]: float(row["value"]) for row in rows if row["metric"] == "order"}
    for integrator, order in {"semi-implicit Euler": 1, "RK4": 4, "implicit midpoint": 2, "linearly implicit": 1}.items():
        demand(abs(orders.get(integrator, 0) - order) < 0.5, f"orders {orders}")
    stiff = {(row["case"], row["variant"]): row["value"] for row in rows if row["section"] == "integration" and row["metric"] == "verdict"}
    demand(stiff["springs of 1e+09", "linearly implicit"] == "good" and stiff["springs of 1e+09", "RK4"] == "bad", f"{stiff}")
    drift = only(rows, case="free motion, step 1 ms", variant="RK4", metric="energy_drift")
    demand(abs(float(drift)) < 1e-6, f"what the damper takes is counted as drift of energy: {drift}")
    steps = {(row["case"], row["variant"]): float(row["value"]) for row in rows if row["metric"] == "largest_stable_step"}
    demand(len(steps) == 12 and steps["springs of 1e+09", "linearly implicit"] == 8e-3 and
           0 < steps["springs of 1e+09", "RK4"] < 1e-4 < steps["springs of 1e+03", "RK4"], f"{steps}")
    numbers = {f"{float(row['value']):{form}}" for row in rows if row["unit"] for form in (".2g", ".3g", "g")}
    numbers |= {f"{float(row['value']) / 1000:.3g}" for row in rows if row["unit"] == "ns" and float(row["value"]) >= 999.5}
    said = [row["metric"] for row in rows if row["section"] == "verdict"]
    order = ["goes_badly", "beside_peers", "goes_well", "weakest", "of_a_quantity"]
    demand(said == sorted(said, key=order.index) and "beside_peers" in said, f"the verdict says {said}")
    for row in rows:
        if row["section"] == "verdict":
            cases = {r["case"] for r in rows if r["section"] == "stability"}
            text = row["value"]
            for case in cases:
                text = text.replace(case, "")
            for number in re.findall(r"(?<![\w.])\d[\d.]*(?:e[+-]\d+)?", text):
                demand(number.rstrip(".") in numbers, f"{number} of '{row['value']}' is no figure of the table")


def only(rows, **wanted):
    found = [row["value"] for row in rows if all(row[key] == value for key, value in wanted.items())]
    demand(len(found) == 1, f"{len(found)} rows are {wanted}")
    return found[0]


def check_others(rows):
    """MuJoCo's point and the task graph's."""
    compared = only(rows, metric="compared_with")
    demand(re.search(r"Boost\.Odeint \d+\.\d+\.\d+ .*MuJoCo \d+\.\d+\.\d+$", compared), f"compared with {compared}")
    of = {"section": "rounding", "quantity": "gravity"}
    slower = float(only(rows, **of, variant="MuJoCo", metric="time_median"))
    form = next(row["variant"] for row in rows if row["variant"].endswith("double, library sines")).split(",")[0]
    chosen = only(rows, **of, variant=form, metric="time_median")
    times = float(only(rows, **of, variant=form, metric="times_faster_than_mujoco"))
    demand(abs(times - slower / float(chosen)) < 1e-9 * times, f"{slower} over {chosen} is not {times}")
    said = [row["value"] for row in rows if row["metric"] == "of_a_quantity" and "MuJoCo" in row["value"]]
    demand(len(said) == 1 and said[0].startswith("g: ") and f"{times:.3g} times" in said[0], f"the verdict says {said}")
    demand(only(rows, metric="beside_peers") == f"{times:.3g} times as fast as MuJoCo (g).", "the verdict is of another peer")
    demand(not any("generic" in row["value"] for row in rows if row["section"] == "verdict"), "the verdict is against ourselves")
    together = {"section": "rounding", "quantity": "all", "variant": "task graph"}
    demand(float(only(rows, **together, metric="time_median")) > 0, "the task graph takes no time")
    demand(only(rows, **together, metric="elements_changed") == "0", "the task graph computes something else")


def read_or_end(screen):
    """What a terminal shows, until nobody writes to it."""
    try:
        return os.read(screen, 65536)
    except OSError:
        return b""


def without_others():
    """Where neither MuJoCo nor oneTBB is to be had, the rest of the report stands and says so."""
    compiler = work / "compiler"
    compiler.write_text("""#!/bin/sh
for word; do
  case $word in -lmujoco | -ltbb)
    echo "ld: cannot find $word: no such file" >&2
    exit 1
  esac
done
exec c++ "$@"
""")
    compiler.chmod(0o755)
    screen, terminal = pty.openpty()  # on a terminal one line tells how far it is, and is gone at the end
    run = subprocess.run([dalembert, "report", robot, "--base", "fixed", "--outputs", "gravity", "--quick", "--compiler",
                          str(compiler), "--flags", f"-O0 -std=c++17 {flags}", "-o", str(work / "without")],
                         stdout=subprocess.PIPE, stderr=terminal, text=True, timeout=300)
    os.close(terminal)
    shown = b""
    while chunk := read_or_end(screen):
        shown += chunk
    shown = shown.decode()
    demand(run.returncode == 0, f"exit status {run.returncode} without MuJoCo: {run.stdout}{shown}")
    demand(shown.count("report: ") > 10 and "\n" not in shown and shown.endswith("\r\033[K"), f"the terminal shows {shown!r}")
    rows = read_rows((work / "without" / "report.csv").read_text())
    compared = only(rows, metric="compared_with")
    demand("not with MuJoCo, which is not found (cannot find -lmujoco: no such file): install" in compared,
           f"compared with {compared}")
    demand(not any(row["variant"] == "MuJoCo" or "mujoco" in row["metric"] for row in rows),
           "MuJoCo's figures come from nowhere")
    why = only(rows, section="rounding", quantity="all", variant="task graph")
    demand("cannot find -ltbb: no such file" in why and "install" in why, f"no task graph: {why}")
    seen = look((work / "without" / "index.html").read_text(), 360, "light")
    demand(seen["drawn"] == "yes", "the page's script does not reach its end without MuJoCo")
    demand(any(words["text"] == why for words in seen["words"]), "the page does not say why there is no task graph")


def stiff_series():
    """A spring too stiff for the reference leaves out what needs it, and not what tells how stiff it is."""
    spring = "{a_02_joint: {k: 1e9, inertia: 0.1}}"
    run = subprocess.run([dalembert, "report", robot, "--base", "fixed", "--outputs", "gravity", "--elastic", spring, "--quick",
                          "--flags", f"-O0 -std=c++17 {flags}", "-o", str(work / "stiff")],
                         capture_output=True, text=True, timeout=300)
    demand(run.returncode == 0, f"exit status {run.returncode} with a stiff spring: {run.stdout}{run.stderr}")
    rows = read_rows((work / "stiff" / "report.csv").read_text())
    why = only(rows, section="integration", case="free motion", metric="not_simulated")
    at_a_millisecond = {row["variant"]: row["value"] for row in rows
                        if row["case"] == "springs of 1e+03" and row["metric"] == "verdict"}
    demand(at_a_millisecond == {"semi-implicit Euler": "bad", "RK4": "bad", "implicit midpoint": "good",
                                "linearly implicit": "good"}, f"{at_a_millisecond}")
    seen = look((work / "stiff" / "index.html").read_text(), 360, "light")
    demand(seen["drawn"] == "yes", "the page's script does not reach its end without a trajectory")
    demand(any(words["text"] == why for words in seen["words"]), "the page does not say why there is no trajectory")


def check_page(page, rows, seen):
    demand(len(page) < 5e6, "the page is larger than 5 MB")
    demand(not re.search(r"<(?:script|link|img)[^>]*(?:src|href)=", page), "the page loads something")
    demand(seen["drawn"] == "yes", "the page's script does not reach its end")
    demand(seen["scroll_width"] <= seen["client_width"], f"the page is {seen['scroll_width']} wide in {seen['client_width']}")

    demand(len(seen["figures"]) > 100, "there are few figures")
    for figure in seen["figures"]:
        row = rows[int(figure["row"])]
        in_microseconds = row["unit"] == "ns" and float(row["value"]) >= 999.5 and figure["unit"] == " µs"
        value = str(float(row["value"]) / 1000) if in_microseconds else row["value"]
        demand(figure["text"] == rounded(value), f"{figure} is not of {row}")
        left, top, right, bottom = figure["box"]
        demand(right > left and bottom > top, f"{figure} is not to be seen")
    symbols = {"g": "gravity", "C": "coriolis_matrix"}
    for words in seen["words"]:
        said = rows[int(words["row"])].values()
        demand(words["text"] in said or symbols.get(words["text"]) in said, f"{words} is not of {rows[int(words['row'])]}")
    names = set(quantities) | {name.replace("_", " ") for name in quantities}
    units = {row["unit"] for row in rows}
    for text in seen["loose"]:  # the frame's own sentences stand in the page word by word
        demand(html.escape(text, quote=False) in page or text in names or text in units, f"'{text}' comes from nowhere")

    plots = {plot["id"]: plot for plot in seen["plots"]}
    wanted = {f"rounding {q}" for q in quantities} | {"sparsity coriolis_matrix", "integration"}
    demand(set(plots) == wanted, f"the plots are {set(plots)}")
    for plot in plots.values():
        left, top, right, bottom = plot["box"]
        demand(right - left > 200 and bottom - top > 100 and right <= seen["client_width"], f"{plot['id']} stands at {plot['box']}")
    for quantity in quantities:
        check_points(plots[f"rounding {quantity}"], rows, 7 if quantity == "gravity" else 6, 2)
    check_points(plots["integration"], rows, 16, 0)
    for path in plots["sparsity coriolis_matrix"]["paths"]:
        drawn = sum(int(n) for n in re.findall(r"h(\d+)v1", path["d"]))
        pattern = rows[int(path["row"])]["value"]
        demand(drawn in (pattern.count("x"), pattern.count("c")), f"{path} draws {drawn} of {pattern}")
    demand(len(seen["fronts"]) >= len(quantities), "a Pareto front is not named")
    chips = [row for row in rows if row["section"] in ("stability", "integration") and row["metric"] == "verdict"]
    demand(len(seen["chips"]) == len(chips), "a verdict is missing")
    for chip in seen["chips"]:
        demand(chip["classes"] == "chip " + rows[int(chip["row"])]["value"], f"{chip} is not of {rows[int(chip['row'])]}")
        demand(chip["colour"] not in ("rgba(0, 0, 0, 0)", seen["paper"]), f"{chip} has no colour")


def check_points(plot, rows, count, bars):
    """Every point stands where its two values put it, inside the plot, with its bars."""
    demand(len(plot["points"]) == count, f"{plot['id']} has {len(plot['points'])} points")
    x, y = ([float(v) for v in plot[axis].split()] for axis in "xy")

    def place(value, low, high, start, end):
        value = min(max(value, low), high)
        return start + (end - start) * math.log(value / low) / math.log(high / low)

    for point in plot["points"]:
        at = [float(v) for v in re.findall(r"-?[\d.]+", point["at"])]
        expected = [place(float(rows[int(point["x_row"])]["value"]), *x), place(float(rows[int(point["y_row"])]["value"]), *y)]
        demand(math.dist(at, expected) < 0.5, f"{plot['id']}: a point at {at} for {expected}")
        demand(point["bars"] == bars, f"{plot['id']}: a point without its bars")
        left, top, right, bottom = point["box"]
        demand(plot["box"][0] <= left and right <= plot["box"][2] and plot["box"][1] <= top and bottom <= plot["box"][3],
               f"{plot['id']}: a point outside")


def must_find(page, rows, spoil, what):
    spoiled = spoil(page)
    demand(spoiled != page, f"nothing to spoil: {what}")
    try:
        check_page(spoiled, rows, look(spoiled, 360, "light"))
    except Wrong:
        return
    raise Wrong(f"the test does not see that {what}")


def shows_what_was_violated(page, rows):
    """Below the case that goes badly; none does, so rows of one are put at the table's end."""
    words = "does not read it, yet 3 elements change"
    case = ["stability", "base at 1e12 m", "gravity", "generated double"]
    more = [[*case, "largest_change", "2", "ulp"], [*case, "violated", words, ""]]
    end = re.search(r'(?m)^const report_csv = ".*(?=";$)', page).end()
    bad = page[:end] + "".join(json.dumps(",".join(f'"{v}"' for v in row) + "\n")[1:-1] for row in more) + page[end:]
    rows = rows + [dict(zip(columns, row)) for row in more]
    seen = look(bad, 360, "light")
    check_page(bad, rows, seen)
    demand(any(word["text"] == words and int(word["row"]) == len(rows) - 1 for word in seen["words"]),
           "the page does not say what was violated")


def begins_with_what_goes_badly(page, rows):
    """A case made to go badly is the first thing seen, and marked, on every screen; and the first row of the matrix."""
    words, why = "Goes badly in double: made up (gravity: made to).", "made to"
    case = {"section": "stability", "case": "made up", "quantity": "gravity", "variant": "generated double"}
    new = list(rows)
    last = max(i for i, row in enumerate(new) if row["section"] == "stability")
    new[last + 1:last + 1] = [dict(case, metric="ulp_worst", value="1e9", unit="ulp"), dict(case, metric="verdict", value="bad", unit=""),
                              dict(case, metric="violated", value=why, unit="")]
    first = min(i for i, row in enumerate(new) if row["section"] == "verdict")
    new.insert(first, {"section": "verdict", "case": "", "quantity": "", "variant": "", "metric": "goes_badly", "value": words, "unit": ""})
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([columns] + [[row[c] for c in columns] for row in new])
    bad = re.sub(r'(?m)^const report_csv = ".*";$', lambda _: f"const report_csv = {json.dumps(text.getvalue())};".replace("<", "\\u003c"),
                 page)
    for width, scheme in [(360, "light"), (360, "dark"), (1200, "light"), (1200, "dark")]:
        seen = look(bad, width, scheme)
        check_page(bad, new, seen)
        said = [word for word in seen["words"] if word["in_verdict"]]
        demand(said[0]["text"] == words and said[0]["box"][3] < 900, f"first of all the page says {said[0]}")
        demand(said[0]["colour"] != seen["paper"] and said[0]["colour"] != "rgba(0, 0, 0, 0)", "what goes badly is not marked")
        demand(all(said[0]["box"][1] <= word["box"][1] for word in said), "something stands above what goes badly")
        demand(seen["first_case"] == "made up", f"the matrix begins with {seen['first_case']}")


def interrupt():
    """An interrupted run leaves what was there, and what it compiled nowhere."""
    before = {path.name: path.read_bytes() for path in (work / "out").iterdir()}
    for by in (signal.SIGINT, signal.SIGKILL):
        with subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL, start_new_session=True,
                              env=os.environ | {"TMPDIR": str(work)}) as run:
            until = time.time() + 60
            while not list(work.glob("dalembert.*")) and time.time() < until:
                time.sleep(0.01)
            time.sleep(0.5)
            demand(list(work.glob("dalembert.*")), "nothing is compiled where TMPDIR says")
            os.killpg(run.pid, by)
            demand(run.wait(60) != 0, "the run is over before it can be interrupted")
    after = {path.name: path.read_bytes() for path in (work / "out").iterdir()}
    demand(before == after, "an interrupted run leaves something behind")
    until = time.time() + 30
    while (left := list(work.glob("dalembert.*"))) and time.time() < until:
        time.sleep(0.1)
    demand(not left, f"an interrupted run leaves {left}")


def main():
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    run = subprocess.run(command, capture_output=True, text=True, timeout=500)
    demand(run.returncode == 0, f"exit status {run.returncode}: {run.stdout}{run.stderr}")
    demand(run.stderr.count("report: ") > 10, "no progress on stderr")
    demand({path.name for path in (work / "out").iterdir()} == {"report.csv", "index.html"}, "other files than two")
    table, page = (work / "out" / "report.csv").read_text(), (work / "out" / "index.html").read_text()
    rows = read_rows(table)
    check_rows(rows)
    papers = set()
    for width, scheme in [(360, "light"), (360, "dark"), (1200, "light")]:
        seen = look(page, width, scheme)
        demand(seen["window_width"] == width, f"the browser's window is {seen['window_width']} wide")
        check_page(page, rows, seen)
        papers.add(seen["paper"])
    demand(len(papers) == 2, f"light and dark have the papers {papers}")
    time_row = next(row for row in rows if row["metric"] == "time_median")
    must_find(page, rows, lambda p: p.replace(f"time_median,{time_row['value']},", "time_median,12345.5,", 1), "a figure is another")
    must_find(page, rows, lambda p: p.replace("\nsparsity();", ""), "a plot is missing")
    must_find(page, rows, lambda p: p.replace("translate(${px},", "translate(${px + 9},"), "points stand elsewhere")
    must_find(page, rows, lambda p: p.replace("main { max-width", "main { min-width: 500px; max-width"), "the page is too wide")
    must_find(page, rows, lambda p: p.replace('"chip " + verdict.value', '"chip weak"'), "a verdict is another")
    shows_what_was_violated(page, rows)
    begins_with_what_goes_badly(page, rows)
    interrupt()
    if "DALEMBERT_LONG_TESTS" in os.environ:  # each a report of its own: half a minute of compiling
        without_others()
        stiff_series()
    print(f"{len(rows)} rows, {len(seen['figures'])} figures, {len(seen['plots'])} plots")


try:
    main()
except Wrong as wrong:
    sys.exit(f"report_test: {wrong}")
