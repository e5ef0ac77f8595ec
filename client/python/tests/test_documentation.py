"""What the pages say of this client is what it does."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("page", ["docs/how-to/python.md", "client/python/README.md"])
def test_every_example_runs(page, addresses, capsys):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
    assert blocks
    names = {}
    for block in blocks:
        at_home = block.replace("127.0.0.1:50051", addresses["server"]).replace("127.0.0.1:50052", addresses["sim-axis"])
        exec(compile(at_home, page, "exec"), names)
    said = capsys.readouterr().out
    # The duration of the plan comes first in both.
    assert said.startswith("0.31333"), said
    assert names["run"].report.axes[0].axis == "x"
