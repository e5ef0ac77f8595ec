"""Type limits, see the motion."""

import csv
import io
import json
import re

import pytest
from playwright.sync_api import expect


def pixels(page, chart):
    """What is drawn, so that it can be told whether it has changed."""
    return page.locator(chart).evaluate("canvas => canvas.toDataURL()")


def fact(page, view, name):
    return page.locator(f"#{view}-summary .fact", has_text=name).locator("b")


def test_a_limit_typed_changes_curve_and_certificate(open_console, picture):
    page = open_console()
    duration = fact(page, "move", "S-curve")
    expect(duration).to_have_text("0.31333 s")
    expect(fact(page, "move", "classification")).to_contain_text("type 1 of 8")
    before = pixels(page, "#move-chart")
    picture(page, "explorer-light")
    page.get_by_label("Velocity", exact=False).locator("visible=true").nth(0)
    page.locator("#move [name=maxVelocity]").fill("0.1")
    # d/v + v/a + a/j: 0.05/0.1 + 0.1/3 + 3/100.
    expect(duration).to_have_text("0.56333 s")
    assert pixels(page, "#move-chart") != before
    expect(page.locator("#move-details")).to_contain_text("Certificate: passed")
    expect(page.locator("#move-details")).to_contain_text("Limits that hold it back")


def test_a_second_family_lies_beside_the_first(open_console, picture):
    page = open_console(scheme="dark")
    page.locator("#move [name=beside]").select_option("POLYNOMIAL:5")
    expect(fact(page, "move", "polynomial, order 5")).to_contain_text("s")
    picture(page, "explorer-dark-beside")


def test_what_cannot_be_says_where_and_what_would_do(open_console, picture):
    page = open_console()
    page.locator("#move [name=maxJerk]").fill("-1")
    field = page.locator("#move label", has=page.locator("[name=maxJerk]"))
    expect(field.locator(".why")).to_contain_text("-1")
    expect(page.locator("#move [name=maxJerk]")).to_have_attribute("aria-invalid", "true")
    page.locator("#move [name=maxJerk]").fill("abc")
    expect(field.locator(".why")).to_have_text("abc is not a number")
    page.locator("#move [name=maxJerk]").fill("100")
    expect(field.locator(".why")).to_have_count(0)
    page.locator("#move [name=distance]").fill("0.0005")
    page.locator("#move [name=endVelocity]").fill("0.2")
    expect(page.locator("#move-state")).to_contain_text("PATH_TOO_SHORT")
    picture(page, "explorer-refused")
    page.locator("#move [name=shortPathPolicy]").select_option("SHORT_PATH_POLICY_NEAREST_VELOCITY")
    expect(fact(page, "move", "not as asked")).to_contain_text("velocity")


def test_what_is_shown_can_be_taken_home(open_console):
    page = open_console()
    expect(fact(page, "move", "S-curve")).to_be_visible()
    files = {}
    for kind in ["json", "csv", "svg"]:
        with page.expect_download() as download:
            page.locator(f"#move-downloads [data-as={kind}]").click()
        assert download.value.suggested_filename == f"move.{kind}"
        files[kind] = download.value.path().read_text()
    plan = json.loads(files["json"])["plan"]
    rows = list(csv.DictReader(io.StringIO(files["csv"])))
    assert len(rows) == int(plan["cycleCount"]) + 1
    assert float(rows[-1]["x.position"]) == 0.05
    assert files["svg"].startswith("<svg") and "NaN" not in files["svg"] and "Jerk [m/s³]" in files["svg"]


def test_points_are_typed_and_their_regions_shown(open_console, picture):
    page = open_console("points")
    expect(page.locator("#rows tr")).to_have_count(4)
    expect(page.locator("#rows .region").first).to_have_text(re.compile("R[1-4]"))
    # Farther than can be reached by then: the velocity is kept, the position is not.
    page.locator("#rows tr").nth(1).locator("input").nth(1).fill("0.2")
    expect(page.locator("#rows .adjusted").first).to_be_visible()
    expect(fact(page, "pvt", "not met as asked")).not_to_have_text("0")
    picture(page, "points-light")
    page.locator("#pvt [name=policy]").select_option("PVT_POLICY_REJECT")
    expect(page.locator("#pvt-state")).to_contain_text("PVT_UNREACHABLE")
    for _ in range(4):
        page.locator("#rows button").first.click()
    expect(page.locator("#pvt-state")).to_contain_text("There is no point yet")
    page.locator("#example-rows").click()
    expect(page.locator("#rows tr")).to_have_count(4)


def test_tables_are_pasted(open_console):
    page = open_console("points")
    expect(page.locator("#rows tr")).to_have_count(4)
    page.locator("#rows input").first.evaluate("""field => {
        const data = new DataTransfer();
        data.setData("text", "time\\tposition\\tvelocity\\n0.1\\t0.005\\t0.1\\n0.15; 0.01; 0.1");
        field.dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, bubbles: true, cancelable: true }));
    }""")
    expect(page.locator("#rows tr")).to_have_count(6)


@pytest.mark.parametrize("view", ["explorer", "points", "live"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_a_phone(open_console, picture, view, scheme):
    page = open_console(view, scheme, width=360, height=740)
    if view != "live":
        expect(page.locator(f"#{'move' if view == 'explorer' else 'pvt'}-summary .fact").first).to_be_visible()
    width = page.evaluate("document.documentElement.scrollWidth")
    assert width <= 360, width
    picture(page, f"phone-{view}-{scheme}")


def test_the_keyboard_gets_everywhere(open_console):
    page = open_console()
    expect(fact(page, "move", "S-curve")).to_be_visible()
    reached = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.name || document.activeElement.id || document.activeElement.textContent"))
    assert {"distance", "maxJerk", "family", "beside", "move-chart", "CSV", "theme"} <= reached, reached
    page.locator("#move-chart").focus()
    before = pixels(page, "#move-chart")
    page.keyboard.press("ArrowRight")
    assert pixels(page, "#move-chart") != before, "the cursor moves by arrow keys"


def test_another_site_cannot_ask(server):
    """By whatever a form can send; the header of the pages makes a browser ask first, and nobody answers."""
    import urllib.error
    import urllib.request

    url = f"http://{server.addresses['serving HTTP']}/console/api/motion.v1.SetpointService/ControlStream"
    body = b'{"stream": "x", "operation": {"requestId": "1", "stop": {}}}'

    def status(**headers):
        request = urllib.request.Request(url, body, {name.replace("_", "-"): value for name, value in headers.items()})
        try:
            return urllib.request.urlopen(request).status
        except urllib.error.HTTPError as error:
            return error.code

    assert status(content_type="text/plain") == 403
    assert status(content_type="application/json") == 403
    assert status(content_type="application/json", x_portamento="console", origin="http://evil.example") == 403
    assert status(content_type="application/json", x_portamento="console", host="evil.example") == 403
    # Ours: there is no such stream.
    assert status(content_type="application/json", x_portamento="console") == 404
