#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of a run that goes on, in Chromium: it changes by itself, leaves its reader in peace, and
ends with the state of the run.

usage: test_view_page.py PROGRAM SOURCE_FOLDER HOLD_AT_CHECKPOINT [unittest options]
"""

import shutil
import sys
import tempfile
import unittest

import netCDF4
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

import view_run
from test_report_page import DESK, DRAWN, PHONE, UNNAMED, WIDE, browser, requests
from test_view import CASE

PROGRAM, HOLD = "", ""


class Live(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.driver = browser()
        cls.addClassCleanup(cls.driver.quit)

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-view-")
        self.addCleanup(shutil.rmtree, self.folder)

    def start(self, *counts, words=()):
        run = view_run.Run(PROGRAM, HOLD, self.folder, CASE, *words, counts=counts)
        for what in (run.process.stdout.close, run.process.stderr.close, run.process.wait, run.process.kill):
            self.addCleanup(what)
        return run

    def size(self, size):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600})

    def open(self, run, motion="reduce"):
        """The page; what moves over it smoothly has no place that could be told."""
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-reduced-motion", "value": motion}]})
        self.driver.get(f"http://127.0.0.1:{run.port}/")

    def wait(self, condition):
        WebDriverWait(self.driver, 60).until(lambda d: d.execute_script("return " + condition))

    def shown(self, records):
        """Waits until the page has drawn so many records."""
        self.wait(f"page.data !== null && page.data.motion.records >= {records}")

    def records(self, run):
        """Of a held run: what its checkpoint has flushed."""
        copy = shutil.copy(run.path, self.folder + "/copy.nc")
        with netCDF4.Dataset(copy) as file:
            return len(file.dimensions["time"])

    def test_it_goes_with_the_run(self):
        run = self.start(2, 6)
        self.size(DESK)
        self.open(run)
        held = run.wait_until_held(2)
        self.shown(self.records(run))
        driver = self.driver
        self.assertEqual(driver.find_element(By.ID, "state").text, "Running")
        self.assertIn("The run goes on", driver.find_element(By.ID, "verdict").text)
        self.assertEqual(driver.title, 'A slope that is "watched" & <told>')
        drawn = driver.execute_script(DRAWN)
        self.assertGreaterEqual(len(drawn), 10)
        self.assertEqual([title for title, much in drawn if not much > 3 and title != "Renormalization map"], [])
        path = "return document.querySelector('#motion path.line').getAttribute('d')"
        first, early = driver.execute_script(path), self.records(run)

        # What the reader holds: a slider at the start, a table, the place on the page, the focus.
        driver.find_element(By.CSS_SELECTOR, "#motion details > summary").send_keys(Keys.ENTER)
        self.wait("document.querySelector('#motion details table') !== null")
        slider = driver.find_element(By.ID, "snapshot")
        self.assertEqual(slider.get_attribute("value"), slider.get_attribute("max"))  # the newest
        slider.send_keys(Keys.HOME)
        top = "return document.querySelector('#cells figure').getBoundingClientRect().top"
        driver.execute_script("document.querySelector('#cells').scrollIntoView({behavior: 'instant'})")
        place = driver.execute_script(top)

        run.release(held)
        held = run.wait_until_held(6)
        self.shown(self.records(run))
        self.assertGreater(self.records(run), early)
        self.assertNotEqual(driver.execute_script(path), first)
        self.assertEqual(driver.execute_script("return [document.activeElement.id, document.activeElement.value]"), ["snapshot", "0"])
        self.assertAlmostEqual(driver.execute_script(top), place, delta=3)
        self.assertTrue(driver.execute_script("return document.querySelector('#motion details').open && document.querySelector('#motion details table') !== null"))
        self.assertEqual(driver.execute_script(UNNAMED), [])

        # The end.
        run.release(held)
        self.wait("live.last.last && page.data.about.status === 'complete' && live.ready === null")
        self.assertEqual(run.end()[0], 0)
        self.assertEqual(driver.find_element(By.ID, "state").text, "Failed")
        self.assertIn("lacuna report out.nc", driver.find_element(By.ID, "after").text)
        self.assertIn("accelerated and failed", driver.find_element(By.ID, "verdict").text)
        self.assertFalse(driver.find_element(By.ID, "live").is_displayed())
        words = driver.find_element(By.CSS_SELECTOR, "#axis label:last-child")
        self.assertEqual(words.text, "Time to failure")
        driver.find_element(By.CSS_SELECTOR, "#axis input[value=before]").send_keys(Keys.SPACE)  # without the server
        drawn = driver.execute_script(DRAWN)
        self.assertEqual([title for title, much in drawn if not much > 0], [])
        text = driver.find_element(By.TAG_NAME, "body").text
        for word in ("NaN", "undefined", "[object", "Infinity"):
            self.assertNotIn(word, text)
        for size in (DESK, PHONE):
            self.size(size)
            self.assertEqual(driver.execute_script(WIDE), [])
        self.assertEqual(driver.get_log("browser"), [])
        here = f"http://127.0.0.1:{run.port}/"
        self.assertEqual({url.removeprefix(here).split("=")[0] for url in requests(driver)}, {"", "data?since"})

    def test_a_jump_is_not_cut_short(self):
        """Data that come in while the page glides to where a link leads are drawn when it is there."""
        run = self.start(2)
        self.size(DESK)
        self.open(run, "no-preference")
        run.wait_until_held(2)
        self.shown(self.records(run))
        driver = self.driver
        driver.execute_script("document.querySelector('nav a[href=\"#solver\"]').click(); live.ready = page.data; drawReady()")
        self.wait("live.ready === null")
        top = "return document.getElementById('solver').getBoundingClientRect().top - parseFloat(getComputedStyle(document.documentElement).scrollPaddingTop)"
        self.assertAlmostEqual(driver.execute_script(top), 0, delta=3)
        # Whether all of the run has come through is said.
        after = driver.find_element(By.ID, "after")
        self.assertIs(driver.execute_script("return live.last.missing"), False)
        self.assertEqual(after.text, "")
        # In one script: what the page asks the run for in between says otherwise.
        said = "return document.getElementById('after').innerText"
        self.assertIn("some is missing here", driver.execute_script(f"showState({{...live.last, missing: true}}); {said}"))
        # So is why it ended, as a sentence.
        stopped = driver.execute_script(f"showState({{...live.last, state: 'interrupted', message: 'interrupted at 1 h; --resume goes on'}}); {said}")
        self.assertTrue(stopped.startswith("The run was stopped: interrupted at 1 h; --resume goes on. This page stays as it is;"), stopped)
        driver.get("about:blank")
        driver.get_log("browser")  # that the server is gone is complained of
        driver.get_log("performance")

    def test_a_run_that_is_killed(self):
        run = self.start(2)
        self.open(run)
        run.wait_until_held(2)
        self.shown(2)
        run.process.kill()
        self.wait("document.getElementById('state').textContent === 'No connection'")
        self.assertGreater(len(self.driver.find_elements(By.CSS_SELECTOR, "#motion figure")), 1)
        self.driver.get("about:blank")
        self.driver.get_log("browser")  # that the server is gone is complained of
        self.driver.get_log("performance")


if __name__ == "__main__":
    PROGRAM, HOLD = sys.argv[1], sys.argv[3]
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
