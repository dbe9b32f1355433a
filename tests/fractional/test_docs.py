"""The page on fractional calculus runs as it stands, in one go."""

import re
from pathlib import Path


def test_every_block_of_the_page_runs(capsys):
    page = Path(__file__).parents[2] / "docs" / "fractional.md"
    text = page.read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) >= 5
    exec(compile("\n".join(blocks), str(page), "exec"), {"__name__": "page"})
    for printed in capsys.readouterr().out.splitlines():
        kept = re.search(r"\d+ modes.*|ExponentialSum.*", printed).group()
        assert f"{kept}`" in text
