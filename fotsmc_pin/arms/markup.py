"""URDF text to an element tree and back, with a parser that refuses hostile XML.

Names keep their prefixes as written (`drake:rotor_inertia`): many files use prefixes without
declaring them, which a parser that knows namespaces refuses. Comments and unknown tags survive.
"""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, Any
from xml.sax import SAXParseException
from xml.sax.handler import ContentHandler, property_lexical_handler
from xml.sax.xmlreader import InputSource

from defusedxml.common import DefusedXmlException
from defusedxml.expatreader import create_parser

from fotsmc_pin.errors import UrdfError

if TYPE_CHECKING:
    from xml.sax.xmlreader import AttributesImpl

LARGEST_FILE = 50_000_000
DEEPEST_NESTING = 100


def parse_urdf(source: bytes | str, origin: str, *, keep_head: bool = False) -> ET.Element:
    """Return the `<robot>` element of a URDF.

    Args:
        source: content of the file; bytes are decoded as the XML declaration says.
        origin: what to call the file in messages.
        keep_head: whether comments above the root, such as a licence, move into it.

    Raises:
        UrdfError: not XML, no `<robot>` root, a document type (which may define entities or
            point at other files), or nesting and size beyond any URDF.
    """
    content = source.encode() if isinstance(source, str) else source
    if len(content) > LARGEST_FILE:
        raise UrdfError(f"{origin}: {len(content) / 1e6:.0f} MB is too large for a URDF")
    document = InputSource()
    document.setByteStream(io.BytesIO(content))
    if isinstance(source, str):
        document.setEncoding("utf-8")
    builder = _TreeBuilder(origin)
    reader = create_parser(forbid_dtd=True)
    reader.setContentHandler(builder)
    reader.setProperty(property_lexical_handler, builder)
    try:
        reader.parse(document)
    except DefusedXmlException:
        raise UrdfError(
            f"{origin}: has a <!DOCTYPE ...>, which may expand entities or read other files "
            "and which no URDF needs; remove it"
        ) from None
    except (SAXParseException, ValueError, LookupError) as error:
        if isinstance(error, UrdfError):
            raise
        raise UrdfError(f"{origin}: not well-formed XML ({error})") from None
    if builder.root.tag != "robot":
        hint = "; expand the xacro macros first" if "xacro" in builder.root.tag else ""
        raise UrdfError(f"{origin}: the root element is <{builder.root.tag}>, not <robot>{hint}")
    if keep_head:
        builder.root[:0] = [ET.Comment(text) for text in builder.head]
    return builder.root


def urdf_text(robot: ET.Element, comment: str = "") -> str:
    """Return the URDF of a tree as text, with `comment` above it."""
    head = '<?xml version="1.0" encoding="utf-8"?>\n'
    if comment:
        # XML forbids two hyphens in a row inside a comment.
        head += f"<!--\n{re.sub('-(?=-)', '- ', comment)}\n-->\n"
    return head + ET.tostring(robot, encoding="unicode").strip() + "\n"


class _TreeBuilder(ContentHandler):
    """Builds an element tree from the events of a parser that leaves prefixes alone."""

    root: ET.Element

    def __init__(self, origin: str) -> None:
        super().__init__()
        self._origin = origin
        self._open: list[ET.Element] = []
        self.head: list[str] = []

    def startElement(self, name: str, attrs: AttributesImpl) -> None:  # noqa: N802
        element = ET.Element(name, dict(attrs.items()))
        if self._open:
            self._open[-1].append(element)
        else:
            self.root = element
        self._open.append(element)
        if len(self._open) > DEEPEST_NESTING:
            raise UrdfError(f"{self._origin}: elements are nested over {DEEPEST_NESTING} deep")

    def endElement(self, name: str) -> None:  # noqa: N802
        self._open.pop()

    def characters(self, content: str) -> None:
        if not self._open:
            return
        parent = self._open[-1]
        if len(parent):
            parent[-1].tail = (parent[-1].tail or "") + content
        else:
            parent.text = (parent.text or "") + content

    def comment(self, content: str) -> None:
        """Keep a comment where it stands, and those above the root apart."""
        if self._open:
            self._open[-1].append(ET.Comment(content))
        elif not hasattr(self, "root"):
            self.head.append(content)

    def _ignore(self, *_: Any) -> None:
        pass

    # The rest of SAX's lexical events carry nothing that a URDF needs.
    startDTD = endDTD = startCDATA = endCDATA = _ignore  # noqa: N815
