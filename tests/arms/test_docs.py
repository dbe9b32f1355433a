"""The examples of docs/bring-your-own-urdf.md run in the order of the page."""

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "bring-your-own-urdf.md"


def test_the_page_runs(made, monkeypatch):
    made.chain("revolute", "revolute").rename(made.folder / "my.urdf")
    monkeypatch.chdir(made.folder)
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) >= 5
    exec("\n".join(blocks), {})
    assert (made.folder / "true.urdf").is_file()
