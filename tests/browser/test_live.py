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


def test_twenty_streams_of_a_server_are_shown(open_console, track, light_axis, picture):
    page = open_console("live", scheme="dark")
    names = [f"cell-{number}/x" for number in range(20)]
    for name in names:
        # Two minutes: none of them ends while a machine that is short of time draws the others.
        track(name, distance=30.0, at=light_axis)
    for name in names:
        # On a machine that is short of time an axis that starves holds by itself, which is shown as well.
        expect(card(page, name).locator(".phase")).to_have_text(re.compile("moving|holding"), timeout=20_000)
        expect(card(page, name).locator(".numbers")).to_contain_text("position", timeout=20_000)
    expect(page.locator("#live-count")).to_have_text("20", timeout=20_000)
    before = {name: cycle_and_position(card(page, name))[0] for name in names}
    for name in names:
        expect(card(page, name).locator(".numbers")).not_to_contain_text(f"cycle {before[name]}", timeout=20_000)
    picture(page, "live-twenty")


# What the page does at a frame, counted: times would tell more of the machine, which may have other things to do.
COUNTED = """() => {
    window.counted = { frames: 0, points: 0 };
    const lineTo = CanvasRenderingContext2D.prototype.lineTo;
    CanvasRenderingContext2D.prototype.lineTo = function (x, y) { counted.points++; lineTo.call(this, x, y); };
    const frame = () => { counted.frames++; requestAnimationFrame(frame); };
    requestAnimationFrame(frame);
}"""


def test_twenty_streams_keep_up(open_console, feed, picture):
    """At a thousand cycles a second each: what is shown follows what is sent, at a cost a frame and in memory that stay as they are."""
    page = open_console("live", at=feed.address)
    expect(page.locator(".stream")).to_have_count(20, timeout=30_000)
    for name in feed.names:
        expect(card(page, name).locator(".numbers")).to_contain_text("µm", timeout=30_000)
    tools = page.context.new_cdp_session(page)
    # Processor time of the page's own thread.
    tools.send("Performance.enable", {"timeDomain": "threadTicks"})

    def spent():
        return {row["name"]: row["value"] for row in tools.send("Performance.getMetrics")["metrics"]}["TaskDuration"]

    def behind():
        """How far what is shown lags behind what is sent [cycles]: of the card that lags most."""
        shown = page.evaluate("""() => Math.min(...[...document.querySelectorAll(".stream .numbers")]
            .map((numbers) => Number(numbers.innerText.match(/cycle\\s+(\\d+)/)[1])))""")
        return feed.cycle() - shown

    def heap():
        tools.send("HeapProfiler.collectGarbage")
        return tools.send("Runtime.getHeapUsage")["usedSize"]

    def plays(seconds):
        """Until every card has gone on by so much; how far each second lagged."""
        lags, until = [], feed.cycle()
        for _ in range(seconds):
            until += 1000
            page.wait_for_function("""(until) => [...document.querySelectorAll(".stream .numbers")]
                .every((numbers) => Number(numbers.innerText.match(/cycle\\s+(\\d+)/)[1]) >= until)""", arg=until, timeout=30_000)
            lags.append(behind())
        return lags

    page.evaluate(COUNTED)
    # Columns are kept for the seconds that are seen: what is kept longer would show from here on.
    plays(6)
    held, busy, begun = heap(), spent(), page.evaluate("({ ...counted, at: performance.now() })")
    lags = plays(8)
    more, busy, ended = heap() - held, spent() - busy, page.evaluate("({ ...counted, at: performance.now() })")
    picture(page, "live-keeps-up")
    frames, points = ended["frames"] - begun["frames"], ended["points"] - begun["points"]
    seconds = (ended["at"] - begun["at"]) / 1000
    print(f"{frames / seconds:.0f} frames/s, {busy / frames * 1e3:.1f} ms of processor time and {points / frames:.0f} points a frame, "
          f"{lags} cycles behind, {held / 1e6:.1f} MB and {more / 1e6:+.1f} MB after 8 s")
    # 160 000 setpoints came. What came is not what is kept: a ring for each column, all there from the first message on.
    assert more < 4e6, more
    # Of the three curves of a card a pixel has a point, however many cycles it stands for; and what is not in view is not drawn.
    assert points / frames < 20_000, (points, frames)
    # The last half lags no more than the first, give or take a message and the reading of the numbers: nothing piles up.
    first, last = lags[:4], lags[4:]
    assert min(last) < min(first) + 1000, lags
    # Drawn in software, on a machine that may have much else to do: with a display and a machine of its own it is the display's rate.
    assert frames > 5 * seconds, (frames, seconds)
