#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Opens a report in headless Chromium and checks that it shows what it should.

usage: page_test.py FLOTILLA [--run DIR] [--screenshots DIR]
Makes a run of boats falling into a bowl (or takes the one in DIR), writes its report, loads it from file:// without a
network, and checks: no error on the console, the canvas shows many colours, playing moves on, pictures at three times
differ, the plots have lines, the keyboard works, a click names a body. Prints the size of the page and the frames per
second of playback.
Exit code: 0 all held, 1 something did not, 77 Chromium or its driver is not installed.
"""
import argparse
import io
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

SKIPPED = 77
# WebGL without a graphics card.
FLAGS = ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--disable-dev-shm-usage", "--hide-scrollbars", "--force-device-scale-factor=1", "--window-size=1400,1000"]
arguments = None


def skip(reason):
    print(f"skipped: {reason} (Debian packages chromium, chromium-driver, python3-selenium, python3-pil)")
    sys.exit(SKIPPED)


try:
    from PIL import Image
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import WebDriverWait
except ImportError as error:
    skip(str(error))


def make_run(flotilla, folder):
    scene = os.path.join(folder, "scene.json")
    with open(scene, "w", encoding="utf-8") as file:
        subprocess.run([flotilla, "scene", "boats-in-bowl", "--bodies", "22", "--seed", "1"], stdout=file, check=True)
    run = os.path.join(folder, "run")
    subprocess.run([flotilla, "run", scene, "--steps", "60", "--output", run, "--quiet"], check=True,
                   stdout=subprocess.DEVNULL)
    return run


def open_browser(folder):
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for flag in FLAGS + [f"--user-data-dir={folder}/profile"]:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


def number_of_colours(image):
    """Of pixels, told apart in steps of 8, that cover more than a speck."""
    colours = image.convert("RGB").resize((350, 200)).point(lambda v: v & 0xF8).getcolors(1 << 24)
    return sum(1 for count, _ in colours if count > 1)


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        run = arguments.run or make_run(arguments.flotilla, cls.folder)
        page = os.path.join(cls.folder, "report.html")
        subprocess.run([arguments.flotilla, "report", run, "--output", page], check=True)
        print(f"page: {os.path.getsize(page) / 1e6:.2f} MB")
        cls.driver = open_browser(cls.folder)
        cls.addClassCleanup(cls.driver.quit)
        begin = time.monotonic()
        cls.driver.get("file://" + page)
        WebDriverWait(cls.driver, 120).until(lambda d: cls.state() != "loading")
        print(f"ready after {time.monotonic() - begin:.2f} s, viewer: {cls.state()}")

    @classmethod
    def state(cls):
        return cls.driver.find_element(By.TAG_NAME, "body").get_attribute("data-viewer")

    def setUp(self):
        self.run_script("flotillaReport.player.toggle(false); flotillaReport.player.seek(0); scrollTo(0, 0)")
        self.settle()

    def run_script(self, script):
        return self.driver.execute_script(script)

    def settle(self):
        """Until two more refreshes have drawn."""
        self.driver.execute_async_script("const done = arguments[0];"
                                         "requestAnimationFrame(() => requestAnimationFrame(() => done()))")

    def seek(self, part):
        self.run_script(f"const p = flotillaReport.player; p.seek(p.start + {part} * (p.end - p.start))")
        self.settle()

    def screenshot(self, name, element=None):
        data = element.screenshot_as_png if element else self.driver.get_screenshot_as_png()
        if arguments.screenshots:
            os.makedirs(arguments.screenshots, exist_ok=True)
            with open(os.path.join(arguments.screenshots, name + ".png"), "wb") as file:
                file.write(data)
        return Image.open(io.BytesIO(data))

    def view(self):
        return self.driver.find_element(By.ID, "view")

    def body(self):
        return self.driver.find_element(By.TAG_NAME, "body")

    def test_loads_without_an_error(self):
        self.assertEqual(self.state(), "ready")
        self.assertEqual(self.driver.find_element(By.ID, "message").text, "")

    def test_shows_bodies_that_move(self):
        images = []
        for part in [0, 0.4, 1]:
            self.seek(part)
            images.append(self.screenshot(f"view-{part}", self.view()))
            colours = number_of_colours(images[-1])
            print(f"colours at {part} of the time: {colours}")
            self.assertGreater(colours, 150)
        self.assertNotEqual(images[0].tobytes(), images[1].tobytes())
        self.assertNotEqual(images[1].tobytes(), images[2].tobytes())

    def test_plays(self):
        frame = "return flotillaReport.player.place().frame"
        before, drawn = self.run_script(frame), self.run_script("return flotillaReport.viewer.framesDrawn")
        self.driver.find_element(By.ID, "play").click()
        begin = time.monotonic()
        time.sleep(2)
        seconds = time.monotonic() - begin
        drawn = self.run_script("return flotillaReport.viewer.framesDrawn") - drawn
        print(f"playback: {drawn / seconds:.1f} frames per second at 1400 x 1000")
        self.assertGreater(self.run_script(frame), before)

    def test_follows_the_keyboard(self):
        frame = "return flotillaReport.player.place().frame"
        self.run_script("document.activeElement.blur()")
        self.body().send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_LEFT)
        self.assertEqual(self.run_script(frame), 2)
        self.body().send_keys(Keys.SPACE)
        self.assertTrue(self.run_script("return flotillaReport.player.playing"))

    def test_orbits_and_zooms(self):
        before = self.screenshot("before", self.view()).tobytes()
        webdriver.ActionChains(self.driver).drag_and_drop_by_offset(self.view(), 120, 40).perform()
        self.settle()
        orbited = self.screenshot("orbited", self.view()).tobytes()
        self.assertNotEqual(before, orbited)
        origin = webdriver.common.actions.wheel_input.ScrollOrigin.from_element(self.view())
        webdriver.ActionChains(self.driver).scroll_from_origin(origin, 0, -400).perform()
        self.settle()
        self.assertNotEqual(orbited, self.screenshot("zoomed", self.view()).tobytes())
        self.run_script("document.getElementById('reset').click()")

    def test_names_a_body_that_is_clicked(self):
        self.seek(1)
        x, y = self.run_script("""
            const { viewer } = flotillaReport, m = viewer.projection, [x, y, z] = viewer.middleOf(0);
            const row = (i) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i];
            return [viewer.canvas.clientWidth * row(0) / row(3) / 2, -viewer.canvas.clientHeight * row(1) / row(3) / 2];""")
        # An open boat may not cover its middle; another one may stand before it. Near it there is one.
        for dx, dy in [(0, 0), (0, 12), (12, 0), (0, -12), (-12, 0), (20, 20), (-20, -20)]:
            webdriver.ActionChains(self.driver).move_to_element_with_offset(
                self.view(), int(x) + dx, int(y) + dy).click().perform()
            self.settle()
            if self.driver.find_element(By.ID, "picked").text:
                break
        self.assertIn("m/s", self.driver.find_element(By.ID, "picked").text)

    def test_has_options_that_change_the_picture(self):
        self.seek(0.4)
        seen = {self.screenshot("default", self.view()).tobytes()}
        for control, value in [("colour", "speed"), ("fixed", "glass"), ("fixed", "solid"), ("fixed", "hidden")]:
            self.run_script(f"const c = document.getElementById('{control}'); c.value = '{value}';"
                            "c.dispatchEvent(new Event('change'))")
            self.settle()
            image = self.screenshot(f"{control}-{value}", self.view())
            self.assertNotIn(image.tobytes(), seen, value)
            seen.add(image.tobytes())
            if value == "speed":
                self.switch_shadows()  # off at first where the processor draws
                seen.add(self.screenshot("shadows", self.view()).tobytes())
                self.assertEqual(len(seen), 3)
                self.switch_shadows()
        self.run_script("for (const [id, value] of [['colour', 'body'], ['fixed', 'cut']]) {"
                        "const c = document.getElementById(id); c.value = value; c.dispatchEvent(new Event('change')) }")

    def switch_shadows(self):
        self.run_script("document.getElementById('shadows').click()")
        self.settle()

    def test_draws_plots_with_values_under_the_mouse(self):
        charts = self.driver.find_elements(By.CSS_SELECTOR, ".chart")
        self.assertGreaterEqual(len(charts), 8)
        self.seek(0.5)
        for chart in charts[:3]:
            self.assertGreater(number_of_colours(self.screenshot("chart", chart)), 4)
        self.run_script("document.querySelector('.chart').scrollIntoView()")
        plot = charts[1].find_element(By.CSS_SELECTOR, ".plot")
        webdriver.ActionChains(self.driver).move_to_element(plot).perform()
        self.settle()
        self.assertIn("step", charts[1].find_element(By.CSS_SELECTOR, ".tip").text)
        self.screenshot("plots")
        before = self.run_script("return flotillaReport.player.time")
        webdriver.ActionChains(self.driver).move_to_element_with_offset(plot, 80, 0).click().perform()
        self.assertNotEqual(self.run_script("return flotillaReport.player.time"), before)

    def test_says_where_the_run_comes_from(self):
        text = self.driver.find_element(By.ID, "tables").text
        for word in ["Summary", "commit", "processor", "friction", "not verified", "flotilla verify"]:
            self.assertIn(word, text)
        self.run_script("document.getElementById('tables').scrollIntoView()")
        self.settle()
        self.screenshot("tables")

    def test_zz_leaves_no_error_on_the_console(self):
        # Named to run last: what the other tests did counts.
        errors = [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]
        print(f"errors on the console: {len(errors)}")
        self.assertEqual(errors, [])


def main():
    global arguments
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("flotilla")
    parser.add_argument("--run")
    parser.add_argument("--screenshots")
    arguments = parser.parse_args()
    if not shutil.which("chromium") or not shutil.which("chromedriver"):
        skip("there is no chromium or no chromedriver")
    result = unittest.main(argv=sys.argv[:1], exit=False, verbosity=2).result
    return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
