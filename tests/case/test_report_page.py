#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of `lacuna report` in Chromium without a head: every chart drawn, nothing complained of,
nothing asked of the network, sliders and keys at work, on a desk and on a phone.

usage: test_report_page.py PROGRAM SOURCE_FOLDER [unittest options]

Leaves pictures in the folder that REPORT_PICTURES names, where it is set.
"""

import base64
import io
import json
import os
import shutil
import sys
import tempfile
import unittest

import matplotlib.image
import netCDF4
import numpy
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

import report_scenes as scenes

PROGRAM, SOURCE, FOLDER = "", "", ""
DESK, PHONE = (1280, 900), (390, 844)

DRAWN = """
return [...document.querySelectorAll('figure')].map((figure) => {
  const title = figure.querySelector('h3').textContent;
  const canvas = figure.querySelector('canvas');
  if (canvas && canvas.dataset.seen) return [title, Number(canvas.dataset.seen)];
  if (canvas) {
    const bytes = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    canvas.dataset.seen = bytes.filter((b, i) => i % 4 === 3 && b > 0).length;  // reading twice is complained of
    return [title, Number(canvas.dataset.seen)];
  }
  const lines = [...figure.querySelectorAll('.frame path.line')].map((p) => p.getTotalLength());
  const dots = figure.querySelectorAll('.frame circle.dot').length;
  const picture = figure.querySelector('.frame image');
  if (picture) return [title, picture.getAttribute('href').length / 100];
  const labels = figure.querySelectorAll('.frame text').length;
  return [title, labels > 4 ? Math.max(dots, ...lines) : 0];
});
"""
ENLARGE = """
const charts = [...document.querySelectorAll('figure')].filter((f) => f.querySelector('[aria-label^="Enlarge"]'));
for (const chart of charts) chart.querySelector('[aria-label^="Enlarge"]').click();
return charts.map((f) => f.querySelector('h3').textContent);
"""
# Charts without numbers on their upright axis.
UPRIGHT = """
return [...document.querySelectorAll('figure')].filter((f) => f.querySelector('.frame svg'))
  .filter((f) => f.querySelectorAll('.frame text[text-anchor=end]').length < 3).map((f) => f.querySelector('h3').textContent);
"""
WIDE = """
return [...document.querySelectorAll('body *')].filter((e) => !e.closest('.scroll, .plain, pre, nav, .skip, svg'))
  .filter((e) => e.getBoundingClientRect().right > document.documentElement.clientWidth + 1).map((e) => e.tagName + '.' + e.className);
"""
UNNAMED = """
return [...document.querySelectorAll('input, select, button, [tabindex], canvas, svg[role]')].filter((e) =>
  !(e.getAttribute('aria-label') || e.labels?.length || e.textContent.trim())).map((e) => e.outerHTML.slice(0, 80));
"""

FAINT = """
const numbers = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
const light = (c) => c.map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)).reduce((s, v, i) => s + v * [0.2126, 0.7152, 0.0722][i], 0.05);
const ground = (node) => { const c = numbers(getComputedStyle(node).backgroundColor); return c[3] === 0 ? ground(node.parentElement) : c.slice(0, 3); };
const shown = (node) => (node ? Number(getComputedStyle(node).opacity) * shown(node.parentElement) : 1);
return [...document.querySelectorAll('h1, h2, h3, p, dt, dd, small, figcaption, summary, th, td, .ends span, nav a, button:enabled, label, legend, svg text')].filter((node) => {
  const under = ground(node), style = getComputedStyle(node), part = shown(node), ink = numbers(node.closest('svg') ? style.fill : style.color).slice(0, 3).map((v, i) => part * v + (1 - part) * under[i]);
  const [dark, bright] = [light(ink), light(under)].sort((a, b) => a - b);
  return node.getClientRects().length > 0 && bright / dark < 4.5;
}).map((node) => node.outerHTML.slice(0, 90));
"""


def browser():
    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def requests(driver):
    """Addresses that the page asked for, its own file and what is inlined excepted."""
    found = []
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            found.append(message["params"]["request"]["url"])
    return [url for url in found if not url.startswith(("file:", "data:"))]


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.driver = browser()
        cls.addClassCleanup(cls.driver.quit)
        for name, text in (("joint", scenes.JOINT), ("block", scenes.BLOCK), ("bare", scenes.BARE), ("brief", scenes.BRIEF), ("far", scenes.FAR),
                           ("line", scenes.LINE), ("turned", scenes.TURNED)):
            scenes.run(PROGRAM, text, os.path.join(FOLDER, name + ".nc"))
            cls.make(name, name)
        scenes.forecasts(PROGRAM, SOURCE, os.path.join(FOLDER, "readings.nc"))
        scenes.driven(os.path.join(FOLDER, "readings.nc"))
        cls.make("readings", "readings")
        cls.make_fitted()
        cls.make_wild()

    @classmethod
    def make(cls, name, run, *words):
        status, _, wrong = scenes.report(PROGRAM, os.path.join(FOLDER, run + ".nc"), "-o", os.path.join(FOLDER, name + ".html"), *words)
        assert status == 0, wrong

    @classmethod
    def make_wild(cls):
        """The joint with numbers at the edge of what there is, and of what slips nothing left."""
        path = os.path.join(FOLDER, "wild.nc")
        shutil.copy(os.path.join(FOLDER, "joint.nc"), path)
        with netCDF4.Dataset(path, "a") as file:
            file["event_potency"][3], file["event_moment"][:] = 1e300, numpy.nan
            file["step_size"][5], file["balance_residual"][5], file["slip"][2] = 1e308, 1e-320, -1e308
            file["n_slip"][:] = 0
            file["apparent_friction"][:] = numpy.nan
            file["apparent_friction"][1:3] = 1e308, -1
        cls.make("wild", "wild")

    @classmethod
    def make_fitted(cls):
        """The block beside readings over most of its life, one of them absurd, and what was fitted to them."""
        with netCDF4.Dataset(os.path.join(FOLDER, "block.nc")) as file:
            time, slip = file["time"][:], file["slip"][:]
        at = numpy.floor(numpy.linspace(0, 0.85 * time[-1], 40))
        seen = numpy.interp(at, time, slip) + 1e-4 * numpy.random.default_rng(1).standard_normal(40)
        scenes.readings(os.path.join(FOLDER, "seen.csv"), at, seen)
        scenes.fit(PROGRAM, scenes.BLOCK, os.path.join(FOLDER, "seen.csv"), os.path.join(FOLDER, "fit.nc"))
        seen[20] = 5.0
        scenes.readings(os.path.join(FOLDER, "absurd.csv"), at, seen)
        with open(os.path.join(FOLDER, "absurd.csv"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        lines[12] = lines[12].split(",")[0] + ",NaN"
        with open(os.path.join(FOLDER, "absurd.csv"), "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
        cls.make("fitted", "block", "--fit", os.path.join(FOLDER, "fit.nc"))
        cls.make("absurd", "block", "--fit", os.path.join(FOLDER, "fit.nc"), "--compare", os.path.join(FOLDER, "absurd.csv"),
                 "--displacement", "move_mm:mm")

    def show(self, name, size=DESK, scheme="light", media="", motion="no-preference"):
        command = self.driver.execute_cdp_cmd
        command("Emulation.setEmulatedMedia", {"media": media, "features": [
            {"name": "prefers-color-scheme", "value": scheme}, {"name": "prefers-reduced-motion", "value": motion}]})
        command("Emulation.setDeviceMetricsOverride",
                {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600})
        self.driver.get("file://" + os.path.join(FOLDER, name + ".html"))
        WebDriverWait(self.driver, 60).until(lambda d: d.execute_script("return document.documentElement.dataset.ready"))

    def tearDown(self):
        self.assertEqual(self.driver.get_log("browser"), [])
        self.assertEqual(requests(self.driver), [])

    def picture(self, name):
        """The whole page as numbers; kept where it is asked for."""
        shot = self.driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True})
        data = base64.b64decode(shot["data"])
        kept = os.environ.get("REPORT_PICTURES")
        if kept:
            with open(os.path.join(kept, name + ".png"), "wb") as file:
                file.write(data)
        return matplotlib.image.imread(io.BytesIO(data), format="png")[..., :3]

    def test_every_chart_is_drawn(self):
        for name, least in (("joint", 17), ("block", 7), ("bare", 8), ("brief", 3), ("far", 3), ("line", 11), ("fitted", 8), ("absurd", 8),
                            ("readings", 7)):
            self.show(name)
            for axis in ("time", "before"):
                self.driver.find_element(By.CSS_SELECTOR, f"#axis input[value={axis}]").send_keys(Keys.SPACE)
                drawn = self.driver.execute_script(DRAWN)
                self.assertGreaterEqual(len(drawn), least, drawn)
                self.assertEqual([title for title, much in drawn if not much > 3], [], (name, axis, drawn))

    def test_numbers_at_the_edge(self):
        self.show("wild")
        titles = self.driver.execute_script(ENLARGE)
        self.assertLessEqual({"Size distribution", "Apparent friction"}, set(titles))
        self.driver.execute_script("for (const tool of document.querySelectorAll('figure .head button')) tool.click()")
        self.assertIn("No cell slips", self.driver.find_element(By.ID, "scales").text)

    def test_sections_without_data_are_left_out(self):
        self.show("block")
        heads = [head.text for head in self.driver.find_elements(By.TAG_NAME, "h2")]
        self.assertEqual(heads, ["Motion", "Forecasts", "Integration", "Case and provenance"])
        links = [link.text for link in self.driver.find_elements(By.CSS_SELECTOR, "nav a")]
        self.assertEqual(links, heads)

    def test_readings(self):
        self.show("readings")
        heads = [head.text for head in self.driver.find_elements(By.TAG_NAME, "h2")]
        self.assertEqual(heads, ["Readings", "Forecasts", "Provenance"])
        self.assertEqual(self.driver.find_element(By.ID, "verdict").text, "Alarm: <b>it</b> accelerates, and most methods agree.")
        facts = self.driver.find_element(By.ID, "facts").text
        for word in ("Level", "alarm", "Failed", "2020-08-12", "p\n0.25"):
            self.assertIn(word, facts)
        strips = "return [...document.querySelectorAll('figure')].map((f) => new Set([...f.querySelectorAll('.frame .level')].map((b) => b.getAttribute('class'))).size)"
        self.assertEqual(self.driver.execute_script(strips), [4] * 7)  # four levels in each chart
        legend = [one.text for one in self.driver.find_elements(By.CSS_SELECTOR, "#readings .legend li")]
        for name in ("quiet", "watch", "warning", "alarm"):
            self.assertIn(f"level: {name}", legend)

    def test_title_is_text(self):
        self.show("joint")
        self.assertEqual(self.driver.find_element(By.ID, "title").text, "A joint & its <b>page</b></script><script>alert(1)</script>")
        self.assertEqual(self.driver.title, "A joint & its <b>page</b></script><script>alert(1)</script>")

    def test_time_slider(self):
        self.show("joint")
        paint = "return [...document.querySelectorAll('#cells canvas')].map((c) => c.toDataURL())"
        slider = self.driver.find_element(By.ID, "snapshot")
        words = self.driver.find_element(By.CSS_SELECTOR, "#cells output")
        seen, texts = [], []
        for key in (Keys.HOME, Keys.ARROW_RIGHT, Keys.END):
            slider.send_keys(key)
            seen.append(self.driver.execute_script(paint))
            texts.append(words.text)
        self.assertEqual(len(set(texts)), 3, texts)
        self.assertIn("failure", texts[2])
        for first, last in list(zip(seen[0], seen[2]))[:3]:  # state, rate, slip
            self.assertNotEqual(first, last)
        self.assertEqual(seen[0][-1], seen[2][-1])  # pressure stands still
        self.assertEqual(slider.get_attribute("aria-valuetext"), texts[2].removeprefix("Time: "))

    def test_scale_slider_moves_the_staircase(self):
        self.show("joint")
        path = "return document.querySelectorAll('#scales figure')[2].querySelector('.frame path.c-fast').getAttribute('d')"
        slider = self.driver.find_element(By.ID, "level-time")
        slider.send_keys(Keys.HOME)
        first = self.driver.execute_script(path)
        slider.send_keys(Keys.END)
        self.assertNotEqual(first, self.driver.execute_script(path))

    def test_forecast_window(self):
        self.show("block")
        bands = "return [...document.querySelectorAll('#motion rect.band')].map((r) => r.getAttribute('x') + ' ' + r.getAttribute('width'))"
        first = self.driver.execute_script(bands)
        self.assertTrue(first)
        slider = self.driver.find_element(By.ID, "issue")
        slider.send_keys(Keys.ARROW_LEFT, Keys.ARROW_LEFT, Keys.ARROW_LEFT)
        self.assertNotEqual(first, self.driver.execute_script(bands))
        select = self.driver.find_element(By.ID, "method")
        before = len(self.driver.find_elements(By.CSS_SELECTOR, "#forecasts circle.dot"))
        select.send_keys(Keys.ARROW_DOWN)
        after = len(self.driver.find_elements(By.CSS_SELECTOR, "#forecasts circle.dot"))
        self.assertLess(after, before)
        self.assertIn("calibrated on simulated failures", self.driver.find_element(By.ID, "forecasts").text)
        self.assertEqual(len(self.driver.find_elements(By.CSS_SELECTOR, "#forecasts tbody tr")), self.driver.execute_script("return page.data.forecasts.methods.length"))

    def test_nothing_strikes_out_a_label(self):
        struck = """
          return [...document.querySelectorAll('.mark-label')].filter((label) => [...label.closest('svg').querySelectorAll('.mark, .line, .dot')].some(
            (other) => label.compareDocumentPosition(other) & Node.DOCUMENT_POSITION_FOLLOWING)).map((label) => label.textContent);
        """
        for name in ("block", "joint", "fitted"):
            self.show(name)
            self.assertGreater(len(self.driver.find_elements(By.CSS_SELECTOR, "#motion .mark-label")), 2)
            self.assertEqual(self.driver.execute_script(struck), [], name)

    def test_maps_open_at_a_time_that_shows_something(self):
        self.show("joint")
        opened = lambda slips: self.driver.execute_script("return firstSnapshot({snapshot_time: new Array(9).fill(0), slipping_cells: arguments[0]})", slips)
        self.assertEqual(opened([0, 1, 2, 3, 5, 9, 9, 9, 9]), 4)   # half of what slips in the end
        self.assertEqual(opened([0, 0, 9, 9, 9, 9, 9, 9, 9]), 6)   # all at once: three quarters on
        self.assertEqual(opened([9, 9, 9, 9, 9, 9, 9, 9, 9]), 6)
        self.assertEqual(opened(None), 6)
        # where a square is one cell nothing is between sticking and slipping
        colours = lambda block: self.driver.execute_script(
            f"return rampOf({{block: {block}}}, {{colours: [STICK, SLIP], ends: ['sticks', 'slips']}}).style.background").count("50%")
        self.assertEqual((colours(1), colours(2)), (2, 0))

    def test_squares_that_slip_backwards(self):
        """They are drawn, in a colour that no range has, and the key says what they are."""
        self.show("turned")
        painted = self.driver.execute_script("""
          const canvas = element('canvas', {width: '4', height: '1'}), map = {map: btoa('\\x00\\xff\\x01\\x00'), backwards: btoa('\\x01\\x00\\x00\\x00')};
          paint(canvas, {nx: 4, ny: 1, place: [0, 1, 2, 3]}, squaresOf(map), RAMP);
          return [[...canvas.getContext('2d').getImageData(0, 0, 4, 1).data], BACK, RAMP]""")
        (pixels, back, ramp) = painted
        self.assertEqual(pixels[0:4], [*back, 255])
        self.assertEqual(pixels[8:12], [*ramp[0], 255])
        self.assertEqual(pixels[15], 0)  # missing
        between = lambda a, b, t: sum((x + t * (y - x) - z) ** 2 for x, y, z in zip(a, b, back)) ** 0.5
        self.assertGreater(min(between(a, b, t / 10) for a, b in zip(ramp, ramp[1:]) for t in range(11)), 60)
        titles = [figure.find_element(By.TAG_NAME, "h3").text for figure in self.driver.find_elements(By.CSS_SELECTOR, "#cells figure")
                  if any("slips backwards" in p.text for p in figure.find_elements(By.CSS_SELECTOR, ".back"))]
        self.assertEqual(titles, ["Slip rate"])

    def test_charts_by_keys(self):
        self.show("joint")
        frame = self.driver.find_element(By.CSS_SELECTOR, "#motion .frame")
        said = self.driver.find_element(By.CSS_SELECTOR, "#motion figure output")
        frame.send_keys(Keys.END)
        last = said.text
        self.assertIn("at failure", last)
        frame.send_keys(Keys.ARROW_LEFT)
        self.assertNotEqual(said.text, last)
        self.assertEqual(frame.get_attribute("aria-valuetext"), said.text)

    def test_tables_by_keys(self):
        self.show("joint")
        closed = self.driver.find_elements(By.CSS_SELECTOR, "details:not(.case) > summary")
        self.assertGreaterEqual(len(closed), 12)
        for summary in closed:
            summary.send_keys(Keys.ENTER)
        built = "details:not(.case) table"  # when the browser says that one has opened
        WebDriverWait(self.driver, 60).until(lambda d: len(d.find_elements(By.CSS_SELECTOR, built)) == len(closed))
        rows = self.driver.execute_script("return [...document.querySelectorAll('details:not(.case) table')].map((t) => t.tBodies[0].rows.length)")
        self.assertTrue(all(0 < n <= 60 for n in rows), rows)
        text = self.driver.find_element(By.TAG_NAME, "main").text
        for word in ("NaN", "undefined", "[object", "Infinity"):
            self.assertNotIn(word, text)

    def test_axis_and_colours(self):
        self.show("block")
        ticks = "return [...document.querySelectorAll('#motion figure text')].map((t) => t.textContent).join(' ')"
        dates = self.driver.execute_script(ticks)
        self.assertIn("2020-01-01", dates)
        self.driver.find_element(By.CSS_SELECTOR, "#axis input[value=before]").send_keys(Keys.SPACE)
        self.assertIn("time before failure", self.driver.execute_script(ticks))
        ground = "return getComputedStyle(document.body).backgroundColor"
        light = self.driver.execute_script(ground)
        self.driver.find_element(By.CSS_SELECTOR, "#theme input[value=dark]").send_keys(Keys.SPACE)
        self.assertNotEqual(light, self.driver.execute_script(ground))

    def test_everything_has_a_name(self):
        for name in ("joint", "line", "fitted"):
            self.show(name)
            self.assertEqual(self.driver.execute_script(UNNAMED), [])

    def test_words_can_be_read(self):
        """Contrast of all words, but of what cannot be used now: 4.5 to 1 (WCAG 2.1, AA)."""
        for scheme in ("light", "dark"):
            self.show("joint", scheme=scheme)
            self.assertEqual(self.driver.execute_script(FAINT), [], scheme)

    def test_requests_would_be_seen(self):
        """That none is found means something: one that is made is found."""
        other = os.path.join(FOLDER, "other.html")
        with open(other, "w", encoding="utf-8") as file:
            file.write('<!doctype html><link rel="icon" href="data:,"><img src="http://127.0.0.1:9/x.png" alt="">')
        self.driver.get("file://" + other)
        self.assertEqual(requests(self.driver), ["http://127.0.0.1:9/x.png"])
        self.assertNotEqual(self.driver.get_log("browser"), [])

    def chart(self, place=0, section="motion"):
        """The frame of a chart, in sight."""
        frame = self.driver.find_elements(By.CSS_SELECTOR, f"#{section} .frame")[place]
        self.driver.execute_script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", frame)
        return frame

    def ticks(self, frame):
        return [text.text for text in frame.find_elements(By.CSS_SELECTOR, "svg text[text-anchor=middle]")]

    def view(self, title):
        return self.driver.execute_script(f"const v = page.views[{json.dumps(title)}]; return {{x: v.x, y: v.y, kind: v.kind, hidden: [...v.hidden]}}")

    def test_drawing_over_a_chart_enlarges_it(self):
        self.show("block")
        frame = self.chart()
        before, wide = self.ticks(frame), frame.rect["width"]
        ActionChains(self.driver).move_to_element_with_offset(frame, -int(wide / 4), 0).click_and_hold().move_to_element_with_offset(
            frame, int(wide / 8), 5).release().perform()
        low, high = self.view("Creep curve")["x"]
        self.assertAlmostEqual(high - low, 3 / 8, delta=0.05)
        self.assertNotEqual(self.ticks(frame), before)
        self.assertIsNone(self.view("Slip rate")["x"])
        ActionChains(self.driver).move_to_element(frame).double_click().perform()
        self.assertIsNone(self.view("Creep curve")["x"])
        self.assertEqual(self.ticks(frame), before)

    def test_enlarging_by_keys(self):
        self.show("block")
        frame, said = self.chart(), self.driver.find_element(By.CSS_SELECTOR, "#motion figure output")
        before = self.ticks(frame)
        frame.send_keys("++++")
        low, high = self.view("Creep curve")["x"]
        self.assertAlmostEqual(high - low, 1 / 16, places=6)
        self.assertIn("Enlarged", said.text)
        frame.send_keys(Keys.END)  # the part follows the cursor
        self.assertAlmostEqual(self.view("Creep curve")["x"][1], 1, places=6)
        frame.send_keys("-")
        low, high = self.view("Creep curve")["x"]
        self.assertAlmostEqual(high - low, 1 / 8, places=6)
        frame.send_keys("0")
        self.assertEqual(self.ticks(frame), before)

    def test_every_chart_can_be_enlarged(self):
        """Those with time upright too: of forecasts beside a run that has not failed, of slip along a line."""
        for name in ("joint", "line", "absurd"):
            self.show(name)
            for axis in ("time", "before"):
                self.driver.find_element(By.CSS_SELECTOR, f"#axis input[value={axis}]").send_keys(Keys.SPACE)
                titles = self.driver.execute_script(ENLARGE)
                self.assertGreater(len(titles), 4)
                self.assertEqual([title for title, much in self.driver.execute_script(DRAWN) if title in titles and not much > 3], [])
                self.assertEqual(self.driver.execute_script(UPRIGHT), [])

    def test_enlarged_ticks_stand_apart(self):
        """However much is enlarged, labels differ and stand in the plot."""
        for name in ("block", "joint"):
            self.show(name)
            for axis in ("time", "before"):
                self.driver.find_element(By.CSS_SELECTOR, f"#axis input[value={axis}]").send_keys(Keys.SPACE)
                frame = self.chart()
                for _ in range(5):
                    frame.send_keys("++")
                    texts = self.ticks(frame)
                    if (name, axis) != ("block", "time"):  # where hours come again day by day, midnight is a date
                        self.assertEqual(len(set(texts)), len(texts), texts)
                    elif len(set(texts)) < len(texts):
                        self.assertTrue(any("-" in text for text in texts), texts)
                    self.assertNotIn("00:00", texts)
                    up = [t.text for t in frame.find_elements(By.CSS_SELECTOR, "svg text[text-anchor=end]")][:-1]
                    self.assertEqual(len(set(up)), len(up), up)

    def test_both_axes_are_enlarged_where_neither_is_time(self):
        self.show("joint")
        frame = self.chart(2, "scales")
        ActionChains(self.driver).move_to_element_with_offset(frame, -60, 60).click_and_hold().move_to_element_with_offset(frame, 60, -60).release().perform()
        view = self.view("Renormalization map")
        self.assertTrue(view["x"] and view["y"], view)

    def test_logarithm_and_names(self):
        self.show("fitted")
        frame = self.chart()
        labels = "return [...document.querySelectorAll('#motion .frame')[0].querySelectorAll('text[text-anchor=end]')].map((t) => t.textContent).join(' ')"
        before = self.driver.execute_script(labels)
        frame.send_keys("l")
        self.assertNotEqual(self.driver.execute_script(labels), before)
        frame.send_keys("l")
        self.assertEqual(self.driver.execute_script(labels), before)
        name = next(b for b in self.driver.find_elements(By.CSS_SELECTOR, "#motion .legend button") if b.text == "readings fitted")
        dots = lambda: len(frame.find_elements(By.CSS_SELECTOR, "circle.dot"))
        self.assertEqual(dots(), 40)
        name.send_keys(Keys.ENTER)
        self.assertEqual((dots(), name.get_attribute("aria-pressed")), (0, "false"))
        name.send_keys(Keys.ENTER)
        self.assertEqual((dots(), name.get_attribute("aria-pressed")), (40, "true"))

    def test_fitted_band(self):
        self.show("fitted")
        frame = self.chart()
        self.assertEqual(len(frame.find_elements(By.CSS_SELECTOR, "path.area")), 2)
        self.assertIn("fitted up to here", frame.text)
        self.assertIn("failure, fitted model", frame.text)
        # the 90 % hold the 50 %, and what was read lies on them
        boxes = [path.rect for path in frame.find_elements(By.CSS_SELECTOR, "path.area")]
        self.assertGreaterEqual(boxes[0]["height"], boxes[1]["height"])
        frame.send_keys(Keys.HOME, *[Keys.ARROW_RIGHT] * 20)
        said = self.driver.find_element(By.CSS_SELECTOR, "#motion figure output").text
        self.assertIn("fitted model", said)
        self.assertIn("Fitted model", [head.text for head in self.driver.find_elements(By.TAG_NAME, "h2")])
        self.assertIn("initial.slip_rate", self.driver.find_element(By.ID, "fit").text)

    def test_line_over_place_and_time(self):
        self.show("line")
        picture = "return document.querySelector('#cells image').getAttribute('href')"
        mark = "return document.querySelector('#cells .mark').getAttribute('y1')"
        place, seen = self.driver.execute_script(mark), self.driver.execute_script(picture)
        self.driver.find_element(By.ID, "snapshot").send_keys(Keys.END)
        self.assertNotEqual(self.driver.execute_script(mark), place)
        self.assertEqual(self.driver.execute_script(picture), seen)
        frame = self.chart(0, "cells")
        ActionChains(self.driver).move_to_element(frame).perform()  # its time becomes the slider's
        self.assertNotEqual(self.driver.find_element(By.ID, "snapshot").get_attribute("value"), self.driver.find_element(By.ID, "snapshot").get_attribute("max"))
        self.assertRegex(self.driver.find_element(By.CSS_SELECTOR, "#cells figure output").text, "km.*before failure: (sticks|slips)")

    def test_order_of_keys(self):
        """From the top the Tab key reaches what leads to the results, the switches, every chart, slider and table, and goes on."""
        self.show("joint")
        body = self.driver.find_element(By.TAG_NAME, "body")
        order = []
        for _ in range(120):
            (body if not order else self.driver.switch_to.active_element).send_keys(Keys.TAB)
            focus = self.driver.switch_to.active_element
            word = focus.get_attribute("id") or focus.get_attribute("class") or focus.tag_name
            if focus.tag_name == "body" or (order and word == "skip"):
                break
            order.append(word)
        self.assertEqual(order[0], "skip")
        charts = len(self.driver.find_elements(By.CSS_SELECTOR, ".frame"))
        self.assertEqual(order.count("frame"), charts)
        self.assertLess(order.index("method"), order.index("issue"))
        self.assertLess(order.index("issue"), order.index("snapshot"))
        self.assertLess(order.index("snapshot"), order.index("level-time"))
        self.assertEqual(order.count("summary"), len(self.driver.find_elements(By.TAG_NAME, "summary")))

    def test_motion_is_reduced(self):
        glide = "return getComputedStyle(document.documentElement).scrollBehavior"
        self.show("brief")
        self.assertEqual(self.driver.execute_script(glide), "smooth")
        self.show("brief", motion="reduce")
        self.assertEqual(self.driver.execute_script(glide), "auto")

    def test_words_of_quantities(self):
        self.show("brief")
        for code, said in (("span(DAY)", "1 day"), ("span(-DAY)", "\u22121 day"), ("span(1.5 * DAY)", "1.5 days"), ("span(YEAR)", "1 year"),
                           ("span(0)", "0 s"), ("span(59.9999)", "1 min"), ("span(59.9)", "59.9 s"), ("span(364.99 * DAY, 6)", "364.99 days"),
                           ("span(1)", "1 s"), ("length(0)", "0 m"), ("length(0.999999)", "1 m"), ("length(2e-12)", "0.002 nm"),
                           ("rate(1)", "1 m/s"), ("many(1, 'cell')", "1 cell"), ("many(0, 'cell')", "0 cells"), ("many(2000, 'cell')", "2 000 cells"),
                           ("denseSpans(DAY, 5 * DAY, 5)[0].label", "1 day")):
            self.assertEqual(self.driver.execute_script("return " + code).replace("\u2009", " "), said, code)

    def test_a_phone_prints_as_a_desk_does(self):
        drawn = """
          window.dispatchEvent(new Event('beforeprint'));
          const edge = document.body.getBoundingClientRect().right + 1;
          const wide = [...document.querySelectorAll('table, svg, p')].filter((e) => e.getBoundingClientRect().right > edge).map((e) => e.textContent.slice(0, 60));
          return [[...document.querySelectorAll('.frame svg')].map((s) => s.viewBox.baseVal.width), wide];
        """
        seen = []
        for size in (DESK, PHONE):
            self.show("block", size, media="print")
            seen.append(self.driver.execute_script(drawn))
        self.assertEqual(seen[0][1], [])
        self.assertEqual(seen[1], seen[0])

    def test_five_maps_print_in_a_row(self):
        self.show("joint", media="print")
        columns = "const maps = document.querySelector('.maps'); maps.append(maps.lastElementChild.cloneNode(true)); return getComputedStyle(maps).gridTemplateColumns.split(' ').length"
        self.assertEqual(self.driver.execute_script(columns), 5)

    def test_dark_pages_print_light(self):
        ground = "const s = getComputedStyle(document.body); return [s.backgroundColor, s.color]"
        self.show("brief", scheme="dark")
        dark = self.driver.execute_script(ground)
        self.show("brief", scheme="dark", media="print")
        light = self.driver.execute_script(ground)
        self.assertEqual(light[0], "rgb(255, 255, 255)")
        self.assertNotEqual(light, dark)
        hidden = "return ['nav', '.controls', '.tools', '.slider button'].map((s) => getComputedStyle(document.querySelector(s) || document.querySelector('nav')).display)"
        self.assertEqual(set(self.driver.execute_script(hidden)), {"none"})

    def test_sizes_and_schemes(self):
        for label, size in (("desk", DESK), ("phone", PHONE)):
            brightness = []
            for scheme in ("light", "dark"):
                for name in ("line", "fitted", "readings", "joint"):
                    self.show(name, size, scheme)
                    self.assertEqual(self.driver.execute_script(WIDE), [], (name, label))
                    self.assertEqual(self.driver.execute_script("return document.documentElement.scrollWidth"), size[0])
                seen = self.picture(f"{label}-{scheme}")
                self.assertEqual(seen.shape[1], size[0])
                self.assertGreater(seen.shape[0], 3 * size[1])
                self.assertGreater(numpy.std(seen), 0.05)
                brightness.append(seen.mean())
            self.assertGreater(brightness[0], brightness[1] + 0.4)

    def test_print(self):
        self.show("joint")
        data = self.driver.execute_cdp_cmd("Page.printToPDF", {"paperWidth": 8.27, "paperHeight": 11.69})["data"]
        pdf = base64.b64decode(data)
        self.assertTrue(pdf.startswith(b"%PDF"))
        self.assertTrue(3 <= pdf.count(b"/Type /Page\n") + pdf.count(b"/Type /Page ") <= 20)


if __name__ == "__main__":
    PROGRAM, SOURCE = sys.argv[1:3]
    FOLDER = tempfile.mkdtemp(prefix="lacuna-page-")
    try:
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
    finally:
        shutil.rmtree(FOLDER)
