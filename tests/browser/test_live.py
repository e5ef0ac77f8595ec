"""Look on at streams, and hold one."""

import re

from playwright.sync_api import expect


def card(page, name):
    return page.locator(".stream", has=page.locator(".name", has_text=re.compile(f"^{re.escape(name)}$")))


def cycle_and_position(stream):
    expect(stream.locator(".numbers")).to_contain_text("position", timeout=20_000)
    numbers = stream.locator(".numbers").inner_text()
    return int(re.search(r"cycle\s+(\d+)", numbers)[1]), re.search(r"position\s+(\S+)", numbers)[1]


def test_without_streams_it_says_what_to_do(open_console, picture):
    page = open_console("live")
    expect(page.locator("#live-state")).to_contain_text("No stream is open here")
    expect(page.locator("#live-state")).to_contain_text("portamento track")
    picture(page, "live-empty")


def test_a_stream_is_held_and_rests_and_goes_on(open_console, track, picture):
    page = open_console("live")
    track("cell-7/x")
    stream = card(page, "cell-7/x")
    expect(stream.locator(".phase")).to_have_text("moving")
    expect(stream.locator(".numbers")).to_contain_text("µm")
    stream.locator("[data-do=hold]").click()
    expect(stream.locator(".said")).to_contain_text("Holds from cycle", timeout=20_000)
    expect(stream.locator(".phase")).to_have_text("holding")
    rest = int(re.search(r"at rest at cycle (\d+)", stream.locator(".said").inner_text())[1])
    page.wait_for_function("""([name, rest]) => [...document.querySelectorAll(".stream")].some((card) =>
        card.querySelector(".name").textContent === name && Number(card.querySelector(".numbers").innerText.match(/cycle\\s+(\\d+)/)?.[1]) > rest + 100)""",
                           arg=["cell-7/x", rest])
    cycle, position = cycle_and_position(stream)
    page.wait_for_function("""([name, cycle]) => [...document.querySelectorAll(".stream")].some((card) =>
        card.querySelector(".name").textContent === name && Number(card.querySelector(".numbers").innerText.match(/cycle\\s+(\\d+)/)?.[1]) > cycle + 300)""",
                           arg=["cell-7/x", cycle])
    later, still = cycle_and_position(stream)
    assert later > cycle and still == position, "cycles go on, and the axis rests"
    picture(page, "live-held")

    stream.locator("[data-do=resume]").click()
    expect(stream.locator(".phase")).to_have_text("moving")
    # By keyboard: 5 % slower, then enlarged.
    stream.focus()
    page.keyboard.press("ArrowLeft")
    expect(stream.locator(".said")).to_contain_text("Goes at 95 %")
    page.keyboard.press("Enter")
    expect(stream).to_have_class(re.compile("large"))
    picture(page, "live-large")
    stream.locator("[data-do=stop]").click()
    expect(stream.locator(".said")).to_contain_text("ended")
    expect(stream.locator("[data-do=hold]")).to_be_disabled()


def test_twenty_streams_keep_up(open_console, track, picture):
    page = open_console("live", scheme="dark")
    names = [f"cell-{number}/x" for number in range(20)]
    for name in names:
        # Two minutes: none of them ends while a machine that is short of time draws the others.
        track(name, distance=30.0)
    for name in names:
        # On a machine that is short of time an axis that starves holds by itself, which is shown as well.
        expect(card(page, name).locator(".phase")).to_have_text(re.compile("moving|holding"), timeout=20_000)
        expect(card(page, name).locator(".numbers")).to_contain_text("position", timeout=20_000)
    expect(page.locator("#live-count")).to_have_text("20")
    frames = page.evaluate("""() => new Promise((done) => {
        const begun = performance.now();
        let frames = 0;
        const next = (now) => { frames++; now - begun < 3000 ? requestAnimationFrame(next) : done(frames / (now - begun) * 1000); };
        requestAnimationFrame(next);
    })""")
    before = {name: cycle_and_position(card(page, name))[0] for name in names}
    page.wait_for_timeout(1000)
    after = {name: cycle_and_position(card(page, name))[0] for name in names}
    picture(page, "live-twenty")
    # Rendered in software, on a machine that also plays twenty axes: far less than with a display, and still a motion.
    print(f"{frames:.0f} frames/s with twenty streams")
    assert frames > 1, frames
    assert all(after[name] > before[name] for name in names)
