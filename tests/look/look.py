# SPDX-License-Identifier: Apache-2.0
"""Pages as people see them, in a real browser: `./run look` makes pages of studies and logs and checks each.

  look.py PROGRAM FOLDER            pages of STUDIES and logs, made and checked; pictures of them are kept in FOLDER
  look.py --page PAGE [RESULTS]     one page, and that its figures are those of the results (JSON)

Of every page: nothing is logged as an error, nothing asked of the network, every plot has as many marks as its numbers
say, sliders and folds answer to mouse and keys, nothing is wider than a phone, and a file is below two megabytes.
"""
import json
import math
import os
import shutil
import subprocess
import sys
import time

from browser import Browser, find_chromium

# Small ones of every kind, and how many runs of each.
STUDIES = {"radar_1d_family": 20, "radar_1d_shift": 5, "manoeuvre_2d": 10, "flight_ajaccio": 5, "bearings_only_family": 4,
           "cho_s1": 4, "passive_sonar_turn": 4, "array_a_10db": 3, "array_births": 2, "array_random": 2, "radar_2d": 8}
MOST_BYTES = 2_000_000
HOSTILE = "<img src=x onerror=alert(1)>&quot;<b>bold</b>"

# What a page holds: of each plot what is drawn and what is told.
READ_PLOTS = r"""
Array.from(document.querySelectorAll("figure"), (figure) => {
  const svg = figure.querySelector("svg.plot"), count = (text, part) => text.split(part).length - 1;
  const marks = svg.querySelector("g.marks"), d = (kind) => Array.from(marks.querySelectorAll("path." + kind), (p) => p.getAttribute("d"));
  const box = svg.getBBox();
  return {
    id: svg.querySelector("title").id.replace(/-title$/, ""),
    title: svg.querySelector("title").textContent, told: svg.querySelector("desc").textContent,
    lines: d("line").length, bands: d("band").length, dots: d("dots").map((p) => count(p, "h0")),
    sights: d("sight").map((p) => count(p, "M")), ellipses: marks.querySelectorAll("ellipse").length,
    cells: d("cells").map((p) => count(p, "z")), width: box.width, height: box.height,
    bad: marks.innerHTML.match(/NaN|inf/g) !== null,
    rows: figure.querySelectorAll("details tbody tr").length, named: svg.querySelectorAll("g.legend text").length };
})
"""

PLAY = r"""
(async () => {
  const told = [];
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  for (const details of document.querySelectorAll("details")) details.open = true;
  for (const box of document.querySelectorAll(".player")) {
    const svg = box.previousElementSibling, slider = box.querySelector("input"), button = box.querySelector("button");
    const length = () => Array.from(svg.querySelectorAll("g.marks path"), (p) => p.getAttribute("d").length).reduce((a, b) => a + b, 0);
    const at = (value) => { slider.value = value; slider.dispatchEvent(new Event("input", { bubbles: true })); return length(); };
    const whole = length(), first = at(slider.min), middle = at((Number(slider.min) + Number(slider.max)) / 2), last = at(slider.max);
    button.click();
    const started = button.textContent;
    let playing = false;
    for (let waited = 0; waited < 5000 && !playing; waited += 50) {  // for a first frame
      await wait(50);
      playing = Number(slider.value) < Number(slider.max);
    }
    button.click();
    told.push({ whole, first, middle, last, started, playing, stopped: button.textContent, label: slider.getAttribute("aria-label") });
    at(slider.max);
  }
  return told;
})()
"""

# Of every table of trackers: name, and the first number of each cell.
READ_TABLE = r"""
Array.from(document.querySelectorAll("table")).filter((t) => t.querySelector("thead th").textContent === "tracker").slice(0, 1).flatMap((table) => {
  const heads = Array.from(table.querySelectorAll("thead th"), (th) => th.textContent);
  return Array.from(table.querySelectorAll("tbody tr"), (tr) => {
    const cells = Array.from(tr.children, (cell) => cell.textContent);
    return { name: tr.querySelector("th").lastChild.nodeName === "#text" ? tr.querySelector("th").textContent : tr.querySelector("th").childNodes[1].textContent,
             values: Object.fromEntries(heads.map((head, i) => [head, cells[i]])) };
  });
})
"""


class Looker:
    """Checks pages and remembers what is wrong with them."""

    def __init__(self, browser, folder=None):
        self.browser, self.folder, self.wrong, self.checked = browser, folder, [], 0

    def expect(self, met, page, what):
        self.checked += 1
        if not met:
            self.wrong.append(f"{page}: {what}")

    def page(self, path, results=None, pictures=False):
        name = os.path.basename(path)
        self.expect(os.path.getsize(path) < MOST_BYTES, name, f"has {os.path.getsize(path)} bytes")
        page = self.browser.open(path)
        plots = page.value(READ_PLOTS)
        self.plots(name, plots)
        if results is not None:
            self.figures(name, page, plots, results)
        if pictures:
            self.pictures(name, page)
        self.controls(name, page)
        page.size(360, 740, phone=True)
        self.expect(page.value("document.documentElement.scrollWidth") <= 360, name, "is wider than a phone")
        smallest = page.value("Math.min(99, ...[...document.querySelectorAll('svg.plot')].filter((p) => p.clientWidth).map("
                              "(p) => parseFloat(getComputedStyle(p).fontSize) * p.getBoundingClientRect().width / p.viewBox.baseVal.width))")
        self.expect(smallest >= 12, name, f"has plots whose text is {smallest:.1f} px high on a phone")
        self.expect(page.value("document.title") == page.value("document.title.trim()") != "", name, "has no title")
        for error in page.errors:
            self.expect(False, name, "logs: " + error)
        for url in page.requests:
            self.expect(url.startswith("file://") and url.endswith(".html"), name, "asks for " + url)
        page.close()
        return plots

    def plots(self, name, plots):
        for plot in plots:
            of = f"{name}: {plot['id']}"
            marks = plot["lines"] + sum(plot["dots"]) + plot["ellipses"] + sum(plot["sights"])
            self.expect(marks > 0 and not plot["bad"], of, "draws nothing, or what is no number")
            self.expect(plot["width"] > 100 and plot["height"] > 100, of, "has no size")
            self.expect(len(plot["told"]) > 20 and plot["title"], of, "has no alternative in words")
            self.expect(plot["rows"] > 0, of, "has no table of its numbers")

    def figures(self, name, page, plots, results):
        by_id = {plot["id"]: plot for plot in plots}
        rows = {row["name"]: row["values"] for row in page.value(READ_TABLE)}
        for tracker, json_of in results["trackers"].items():
            self.expect(tracker in rows, name, f"has no row of {tracker}")
            for head, shown in rows.get(tracker, {}).items():
                if not head.endswith(")") or " RMSE (" not in head:
                    continue
                value = rmse_of(json_of["rmse"], head)
                self.expect(same(shown, value), name, f"says {shown} of {tracker} where the results have {value}")
            correction = json_of.get("details", {}).get("correction")
            if correction and len(correction.get("rules", [])) > 1:
                place = list(results["trackers"]).index(tracker)
                fired = by_id.get(f"correction_{place}_fired")
                self.expect(fired and fired["dots"] == [len(correction["rules"])] * 2, name, f"lacks dots of {tracker}'s rules")
                self.expect(sum(id.startswith(f"correction_{place}_feature_") for id in by_id) == len(correction["features"]),
                            name, f"lacks features of {tracker}")
        if not results.get("sets"):
            for quantity in {q for t in results["trackers"].values() for q in t["rmse"]}:
                plot = by_id.get(f"error_{quantity}")
                series = [o["series"]["rmse"].get(quantity, []) for o in list(results["trackers"].values())]
                extra = [b["series"]["rmse"].get(quantity, []) for n, b in results["bounds"].items()
                         if n not in results["trackers"] and "series" in b]
                drawn = sum(any(v is not None for v in one) for one in series + extra)
                self.expect(plot is None or plot["lines"] == drawn, name, f"error_{quantity} has not the {drawn} lines of the results")
        for number, (pair, differences) in enumerate(results.get("paired", {}).items()):
            a, b = pair.split(" - ")
            for quantity in differences:
                plot = by_id.get(f"pair_{number}_{quantity}")
                runs = [results["trackers"].get(t, {}).get("details", {}).get("run_rmse", {}).get(quantity) for t in (a, b)]
                if plot is None or None in runs:
                    continue
                both = sum(x is not None and y is not None for x, y in zip(*runs))
                self.expect(plot["dots"] == [both], name, f"{plot['id']} has {plot['dots']} dots for {both} runs")
        for picture in results.get("pictures", []):
            plot = by_id.get(f"run_{picture['which']}")
            self.expect(plot is not None, name, f"does not draw the {picture['which']} run")
            if plot and picture.get("measured", {}).get("y"):
                count = sum(y is not None for y in picture["measured"]["y"])
                self.expect(count in plot["dots"], name, f"run_{picture['which']} has not the {count} measurements of the results")

    def controls(self, name, page):
        for player in page.value(PLAY):
            self.expect(player["first"] < player["middle"] < player["last"] == player["whole"], name, f"a slider hides nothing: {player}")
            self.expect(player["started"] == "Stop" and player["playing"] and player["stopped"] == "Play", name, f"does not play: {player}")
            self.expect(player["label"], name, "has a slider without a name")
        if page.value("document.querySelectorAll('.player input').length") > 0:
            page.value("document.querySelector('.player input').focus()")
            page.key("Home")
            self.expect(page.value("(s => s.value === s.min)(document.activeElement)"), name, "its slider does not obey keys")
            page.key("End")
        if page.value("document.querySelectorAll('summary').length") > 0:
            for opened in (True, False):
                page.value(f"(s => {{ s.parentElement.open = {str(not opened).lower()}; s.focus(); }})(document.querySelector('summary'))")
                page.key("Enter")
                self.expect(page.value("document.querySelector('summary').parentElement.open") == opened, name, "a fold does not obey keys")
        page.value("document.querySelectorAll('details').forEach((d) => { d.open = false; })")

    def pictures(self, name, page):
        if not self.folder:
            return
        stem = os.path.join(self.folder, os.path.splitext(name)[0])
        for kind, width, scheme, medium in (("light", 1280, "light", ""), ("dark", 1280, "dark", ""), ("phone", 390, "light", ""),
                                            ("print", 800, "light", "print")):
            page.size(width, 900, phone=kind == "phone")
            page.media(scheme, medium)
            page.picture(f"{stem}_{kind}.png")
        page.media()
        page.size(1280, 900)


def unit_in(head):
    return head[head.rindex("(") + 1:-1]


def rmse_of(rmse, head):
    """The value of the quantity that a heading such as "position RMSE (m)" names."""
    name = head[:head.index(" RMSE (")]
    units = {"m/s": "mps", "Hz": "hz"}
    for quantity, value in rmse.items():
        stem, _, unit = quantity.rpartition("_")
        if stem.replace("_", " ") == name.replace("_", " ") and units.get(unit_in(head), unit_in(head)).replace("/", "p") == unit:
            return value
    return None


def same(shown, value):
    """Does a cell begin with that value, to the four digits that it shows?"""
    text = shown.split("±")[0].replace("\u202f", "").replace("\u2212", "-").replace("best", "").strip()
    if value is None or not math.isfinite(value):
        return text == "-"
    return text != "-" and math.isclose(float(text), value, rel_tol=6e-4)


def run(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(arguments)}: {done.stderr}")
    return done.stdout


def bearings_log(path):
    """A ship that turns hears a target go by."""
    with open(path, "w") as file:
        file.write("time_s,bearing_deg,bearing_sigma_deg,sensor_east_m,sensor_north_m\n")
        for k in range(1, 61):
            north, east = (50.0 * k, 0.0) if k <= 30 else (1500.0, 50.0 * (k - 30))
            bearing = math.degrees(math.atan2(8000.0 - 20.0 * k - east, 5000.0 - north))
            file.write(f"{10 * k},{bearing + 0.4 * math.sin(9.7 * k) + (6.0 if k == 20 else 0.0):.6f},0.5,{east},{north}\n")


def pages_of_studies(looker, program, folder):
    for study, runs in STUDIES.items():
        page, kept = os.path.join(folder, study + ".html"), os.path.join(folder, study + ".json")
        run(program, "compare", study, "--runs", str(runs), "--json", kept, "--report", page, "--quiet")
        with open(kept) as file:
            results = json.load(file)
        plots = looker.page(page, results, pictures=True)
        print(f"{study}: {len(plots)} plots, {os.path.getsize(page) // 1000} kB")


def pages_of_logs(looker, program, folder):
    bearings = os.path.join(folder, "bearings.csv")
    bearings_log(bearings)
    run(program, "tma", bearings, "--report", os.path.join(folder, "tma.html"))
    looker.page(os.path.join(folder, "tma.html"), pictures=True)
    run(program, "simulate", "manoeuvre_2d", "--runs", "1", "--seed", "3", "-o", os.path.join(folder, "logs"))
    log = os.path.join(folder, "without_truth.csv")
    source = next(os.path.join(folder, "logs", f) for f in sorted(os.listdir(os.path.join(folder, "logs"))) if f.endswith(".csv"))
    without_truth(source, log)
    run(program, "track", "manoeuvre_2d", log, "--report", os.path.join(folder, "log.html"))
    plots = looker.page(os.path.join(folder, "log.html"), pictures=True)
    looker.expect(any(plot["id"] == "tracks" for plot in plots), "log.html", "does not draw the tracks")
    innovations = [plot["id"] for plot in plots if plot["id"].startswith(("innovations_", "nis_"))]
    # With its truth a log is scored, and says the rest as well.
    for page, *command in (("log_with_truth.html", "track", "manoeuvre_2d", source),
                           ("log_afresh.html", "compare", "manoeuvre_2d", "--truth", source, "--runs", "5", "--quiet")):
        kept = os.path.join(folder, page.replace("html", "json"))
        run(program, *command, "--json", kept, "--report", os.path.join(folder, page))
        with open(kept) as file:
            results = json.load(file)
        plots = looker.page(os.path.join(folder, page), results, pictures=True)
        shown = [plot["id"] for plot in plots]
        looker.expect(innovations and all(one in shown for one in innovations), page, "does not show all innovations")
        looker.expect("run_median" in shown, page, "does not draw the median run")
    return bearings, log


def without_truth(source, target):
    with open(source) as read, open(target, "w") as write:
        rows = [line.rstrip("\n").split(",") for line in read if not line.startswith("#")]
        kept = [i for i, column in enumerate(rows[0]) if not column.startswith("truth")]
        for row in rows:
            write.write(",".join(row[i] for i in kept) + "\n")


def hostile_names(looker, program, folder, bearings, log):
    with open(os.path.join(folder, "radar_1d_family.json")) as file:
        text = file.read().replace("radar_1d_family", json.dumps(HOSTILE)[1:-1]).replace('"nfnn', '"' + json.dumps(HOSTILE)[1:-1])
    kept, page = os.path.join(folder, "hostile.json"), os.path.join(folder, "hostile.html")
    with open(kept, "w") as file:
        file.write(text)
    run(program, "report", kept, "-o", page)
    pages = [page]
    for number, (command, source) in enumerate((("tma", bearings), ("track", log))):
        name = os.path.join(folder, HOSTILE.replace("/", "") + f"{number}.csv")
        shutil.copy(source, name)
        page = os.path.join(folder, f"hostile_{command}.html")
        run(program, command, *(["manoeuvre_2d"] if command == "track" else []), name, "--report", page)
        pages.append(page)
    for page in pages:
        looker.page(page)
        opened = looker.browser.open(page)
        looker.expect(opened.value("document.querySelectorAll('img, b').length") == 0, page, "made elements of a name")
        looker.expect("<img src=x onerror=alert(1)>" in opened.value("document.body.textContent"), page, "does not say the name")
        opened.close()


def must_be_caught(browser, folder):
    """The looker itself: a page that is at fault in every way has to be found out."""
    path = os.path.join(folder, "at_fault.html")
    with open(path, "w") as file:
        file.write("<!DOCTYPE html><html><head><title>x</title></head><body><figure><svg class='plot'><title id='a-title'>t</title>"
                   "<desc>d</desc><g class='marks'></g></svg></figure><div style='width:900px'>wide</div>"
                   "<img src='http://localhost:9/x.png'><script>console.error('an error'); throw new Error('thrown');</script></body></html>")
    looker = Looker(browser)
    looker.page(path)
    for part in ("draws nothing", "an error", "thrown", "asks for http", "wider than a phone", "no table"):
        if not any(part in wrong for wrong in looker.wrong):
            sys.exit(f"look.py: does not notice: {part}; only {looker.wrong}")
    os.remove(path)


def end(looker, began):
    for wrong in looker.wrong:
        print(wrong, file=sys.stderr)
    print(f"{looker.checked} checks, {len(looker.wrong)} of them failed, {time.monotonic() - began:.0f} s")
    sys.exit(1 if looker.wrong else 0)


def main(arguments):
    program = find_chromium()
    if not program:
        sys.exit("look.py: there is no chromium; on Debian: apt-get install chromium")
    began = time.monotonic()
    if arguments[:1] == ["--page"] and len(arguments) in (2, 3):
        results = None
        if len(arguments) == 3:
            with open(arguments[2]) as file:
                results = json.load(file)
        with Browser(program) as browser:
            looker = Looker(browser)
            looker.page(arguments[1], results)
        end(looker, began)
    if len(arguments) != 2:
        sys.exit(__doc__)
    truebearing, folder = arguments
    os.makedirs(folder, exist_ok=True)
    with Browser(program) as browser:
        must_be_caught(browser, folder)
        looker = Looker(browser, folder)
        pages_of_studies(looker, truebearing, folder)
        bearings, log = pages_of_logs(looker, truebearing, folder)
        hostile_names(looker, truebearing, folder, bearings, log)
    end(looker, began)


if __name__ == "__main__":
    main(sys.argv[1:])
