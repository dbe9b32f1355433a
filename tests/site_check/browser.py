"""Every page of a built site in a browser without network: axe, its complaints, first screens."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests.chromium import chromium

if TYPE_CHECKING:
    from collections.abc import Callable

AXE = Path(__file__).parents[1] / "view/assets/axe.min.js"
GRAVE = ("serious", "critical")

LAPTOP = {"viewport": {"width": 1366, "height": 768}}
PHONE = {
    "viewport": {"width": 390, "height": 844},
    "device_scale_factor": 2,
    "is_mobile": True,
    "has_touch": True,
}
SCREENS: dict[str, dict[str, Any]] = {
    "laptop": LAPTOP,
    "phone": PHONE,
    "laptop-dark": LAPTOP | {"color_scheme": "dark"},
    "phone-dark": PHONE | {"color_scheme": "dark"},
}
"""Screens on which a page is looked at."""

# Frames are pages of the site themselves. A shadow's text cannot be told from the page's by axe.
RUN_AXE = """async () => {
  const found = await axe.run(document, { iframes: false, resultTypes: ["violations"] });
  return found.violations.map((rule) => ({
    id: rule.id, impact: rule.impact, help: rule.help,
    nodes: rule.nodes.map((node) => node.html.slice(0, 160)),
  }));
}"""
TOO_WIDE = "document.documentElement.scrollWidth - document.documentElement.clientWidth"


@dataclass
class Findings:
    """What was found on all pages."""

    looked_at: int = 0
    grave: list[str] = field(default_factory=list)
    mild: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{self.looked_at} pages on screens, {len(self.grave)} grave findings, "
            f"{len(self.mild)} mild ones"
        )


def look_at(
    pages: list[Path], site: Path, pictures: Path, screens: list[str], say: Callable[[str], None]
) -> Findings:
    """Run axe on each page on each screen, and keep pictures of its first screen."""
    findings = Findings()
    script = AXE.read_text("utf-8")
    with chromium() as browser:
        for screen in screens:
            context = browser.new_context(offline=True, reduced_motion="reduce", **SCREENS[screen])
            (pictures / screen).mkdir(parents=True, exist_ok=True)
            context.set_default_timeout(120_000)
            for path in pages:
                name = path.relative_to(site).as_posix()
                page = context.new_page()
                complaints: list[str] = []
                _listen(page, complaints)
                page.goto(path.as_uri())
                _settle(page)
                picture = name.removesuffix(".html").replace("/", "-") + ".jpg"
                page.screenshot(path=pictures / screen / picture, quality=85, type="jpeg")
                where, before = f"{name}, {screen}", len(findings.grave)
                findings.grave += [f"{where}: {text}" for text in complaints]
                if (beyond := page.evaluate(TOO_WIDE)) > 0:
                    findings.grave.append(f"{where}: wider than the screen by {beyond} px")
                page.evaluate(script)
                _sort(page.evaluate(RUN_AXE), where, findings)
                findings.looked_at += 1
                for grave in findings.grave[before:]:
                    say(grave)
                page.close()
            say(f"{screen}: {findings}")
            context.close()
    return findings


def _listen(page: Any, complaints: list[str]) -> None:
    page.on("pageerror", lambda error: complaints.append(f"error: {error}"))

    def hear(message: Any) -> None:
        # Chromium's own note that software rendering reads pixels slowly is not the page's.
        if message.type in ("error", "warning") and "GPU stall" not in message.text:
            complaints.append(f"{message.type}: {message.text}")

    def ask(request: Any) -> None:
        if not request.url.startswith(("file:", "data:", "blob:")):
            complaints.append(f"asked the network for {request.url}")

    page.on("console", hear)
    page.on("request", ask)


def _settle(page: Any) -> None:
    """Wait until arms are drawn and formulas are set."""
    for frame in page.frames:
        if frame.locator("[data-part=scene]").count():
            frame.locator("html[data-ready]").wait_for(state="attached", timeout=60_000)
    page.wait_for_timeout(300)


def _sort(violations: list[dict[str, Any]], where: str, findings: Findings) -> None:
    for rule in violations:
        kind = findings.grave if rule["impact"] in GRAVE else findings.mild
        for node in rule["nodes"]:
            kind.append(f"{where}: {rule['impact']}: {rule['id']} ({rule['help']}): {node}")
