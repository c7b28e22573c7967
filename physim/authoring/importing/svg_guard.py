"""First look at an SVG file: what could harm or surprise is found before any library reads it.

Entities are refused where they are declared, references to other files where they stand, and
copies of copies (``use``) are counted before they are made. The line of every id is kept for
messages.
"""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat

from physim.authoring.importing.drawing import ImportSourceError, refused
from physim.authoring.importing.svg_bare import (
    DRAWN,
    LABEL,
    LINK,
    MOVING,
    NOT_DRAWN,
    NOT_LINES,
    ONLY_COPIED,
    SVG,
    called,
    copied,
    hidden,
    is_hidden,
)
from physim.authoring.importing.svg_copies import MOST_COPIES, Element, written_out
from physim.authoring.importing.svg_css import MOVES, SHOWN
from physim.authoring.importing.svg_look import SvgLook
from physim.authoring.importing.svg_paths import path_fault
from physim.authoring.importing.svg_sheets import (
    BEYOND,
    Sheets,
    StyleError,
    declarations,
    hidden_by,
    sheets_of,
)
from physim.authoring.importing.svg_values import (
    NUMBER,
    ORIGINS,
    SHAPES,
    SIZES,
    TAKES,
    origin_of,
    page_fault,
    shape_fault,
    transform_fault,
    turns,
)
from physim.escaping import escaped

MOST_ELEMENTS = 100_000
"""Elements of a drawing, copies written out."""
MOST_NESTED = 2_000_000
"""Elements, each counted as often as groups stand about it: the work of reading them."""
MOST_NUMBERS = 300_000
"""Numbers of all path data: the work of reading them."""
MOST_TURNED = 150_000
"""Functions of transforms, each counted for every element that it moves, copies written out."""

LANGUAGE = "systemLanguage"
"""Attribute by which an element is drawn or not, which depends on who looks"""
NO_ORIGIN = "transforms are read about (0, 0) alone; apply it to the shape (Inkscape: ungroup)"


def look_at(path: Path, text: str) -> SvgLook:
    """Check an SVG text. Raises ImportSourceError with file:line."""
    return _Guard(path).run(text)


class _Guard:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.look = SvgLook()
        self.elements: dict[str, Element] = {}
        self.uses: list[tuple[str, str]] = []  # where copies stand that are to be seen, and of what
        self.empty = {""}  # ids of what draws nothing wherever it is copied
        self.open: list[tuple[str, Element]] = []
        self.all = Element()
        self.seen = 0
        self.nested = 0
        self.drawn = 0
        self.hidden = 0
        self.sheets = Sheets()
        self.has_names = True  # whether elements are of the namespace of SVG, as they should be
        self.parser = expat.ParserCreate("utf-8", namespace_separator="|")

    def run(self, text: str) -> SvgLook:
        self.sheets = sheets_of(text, lambda *wrong: refused(self.path, *wrong))
        self.look.may_be_painted = self.sheets.may_paint
        if self.sheets.imports:
            self.look.left_out.append("<style> imports another style sheet, which is not read")
        parser = self.parser
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.EntityDeclHandler = self._entity
        parser.ExternalEntityRefHandler = self._external
        parser.SkippedEntityHandler = self._entity
        parser.ProcessingInstructionHandler = self._instruction
        try:
            parser.Parse(text.encode("utf-8"), True)
        except expat.ExpatError as error:
            reason = expat.ErrorString(error.code)
            raise refused(self.path, f"not valid XML: {reason}", error.lineno) from None
        if self.sheets.other:
            self.look.left_out.append(f"<style>: {self.sheets.other}, which is not applied")
        self.look.left_out += [
            f'{where} copies "{escaped(name[:60])}", which is nothing drawn in this file; left out'
            for where, name in self.uses
            if name in self.empty or name not in self.elements
        ]
        count, turned = written_out(self.all, self.elements, self._not_copied)
        if count > MOST_ELEMENTS:
            raise refused(self.path, f"more than {MOST_ELEMENTS} elements, copies written out")
        if turned > MOST_TURNED:
            raise refused(
                self.path,
                f"transforms of groups and shapes add up to more than {MOST_TURNED} functions; "
                "apply them to the shapes (Inkscape: ungroup)",
            )
        return self.look

    def _refused(self, message: str) -> ImportSourceError:
        return refused(self.path, message, self.parser.CurrentLineNumber)

    def _entity(self, *_: object) -> None:
        raise self._refused("declares an XML entity; save the drawing as plain SVG without any")

    def _external(self, *_: object) -> int:
        raise self._refused("refers to an external entity; nothing outside the file is read")

    def _instruction(self, target: str, _: str) -> None:
        if target == "xml-stylesheet":
            line = self.parser.CurrentLineNumber
            self.look.left_out.append(f"line {line}: a style sheet in a file of its own, not read")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        line = self.parser.CurrentLineNumber
        if not self.open:
            self.has_names = name.startswith(SVG)
        if self.has_names and "|" not in name:  # taken out of the namespace
            name = f"|{name}"
        tag = name.removeprefix(SVG)
        styled = self._styled(tag, attributes)
        attributes = self._shown(tag, styled)
        is_misplaced = attributes is not styled
        self._check_shown(tag, attributes)
        if hides := is_hidden(attributes):
            attributes = hidden(attributes)
        fault = self._fault(tag, attributes)
        self.look.bare.start(name, attributes, line, fault)
        if not self.open:
            self._check_root(tag, name, attributes, hides)
        self._count(attributes)
        self._hide(tag, attributes, hides)
        if tag in SHAPES and not self.hidden:
            self.look.drawn.append((line, called(tag, attributes)))
        self._enter(tag, attributes, is_misplaced)

    def _styled(self, tag: str, attributes: dict[str, str]) -> dict[str, str]:
        """Attributes with what style sheets say."""
        try:
            return self.sheets.styled(tag, attributes)
        except StyleError as error:
            raise self._refused(f"{called(tag, attributes)}: {error}") from None

    def _shown(self, tag: str, attributes: dict[str, str]) -> dict[str, str]:
        """Attributes, of what is not drawn where it stands so that it is hidden."""
        within = self.open[-1][0] if self.open else ""
        if within == "switch" and "|" not in tag:
            attributes = self._alternative(attributes)
        elif "requiredExtensions" in attributes:
            attributes = hidden(attributes)
        is_drawn = within not in TAKES and not within == tag == "a"  # a shape, a copy, or a link
        return attributes if is_drawn else hidden(attributes)

    def _check_root(self, tag: str, name: str, attributes: dict[str, str], hides: bool) -> None:
        self.look.page = attributes
        self.look.line = self.parser.CurrentLineNumber
        if tag != "svg":
            raise self._refused(f"the root is <{escaped(name[:40])}>, not <svg>")
        if hides:
            raise self._refused("the whole drawing is hidden, by display or opacity")
        if wrong := page_fault(attributes):
            raise self._refused(f"{called(tag, attributes)}: {wrong}")

    def _count(self, attributes: dict[str, str]) -> None:
        """Refuse more than can be read."""
        self.seen += 1
        if self.seen > MOST_ELEMENTS:
            raise self._refused(f"more than {MOST_ELEMENTS} elements")
        self.nested += len(self.open)
        if self.nested > MOST_NESTED and len(self.open) > MOST_COPIES:
            raise self._refused(
                f"{len(self.open)} groups within each other, with too many elements in them; "
                "ungroup some of them"
            )
        for key in ("d", "points"):
            self.drawn += len(NUMBER.findall(attributes.get(key, "")))
        if self.drawn > MOST_NUMBERS:
            raise self._refused(
                f"more than {MOST_NUMBERS} numbers in its paths up to here; simplify them first, "
                "or delete what is no wall, obstacle, path or robot"
            )

    def _hide(self, tag: str, attributes: dict[str, str], hides: bool) -> None:
        """Take note of what is not seen, with all in it, and tell the first of it."""
        told = ""
        if tag in MOVING or tag.endswith("script"):  # wherever it stands
            name = escaped(tag.rpartition("|")[2])[-40:]
            told = f"<{name}>, not followed: what it changes is taken as it stands"
        elif self.hidden or tag in NOT_DRAWN:
            self.hidden += 1
            return
        elif tag == LINK:
            told = "a style sheet in a file of its own, not read"
        elif hides:
            label = escaped(attributes.get(LABEL, attributes.get("id", "")))[:60]
            told = f"hidden <{escaped(tag)[:40]}> {label}".rstrip() + ", left out"
        elif tag in NOT_LINES:
            told = f"<{tag}> holds no lines, left out"
        for key in attributes if not self.hidden else ():
            if key.startswith("on"):
                label = f"{called(tag, attributes)}: its {escaped(key)[:40]}"
                self.look.left_out.append(
                    f"line {self.parser.CurrentLineNumber}: {label}, a script, is not followed"
                )
        self.hidden = self.hidden + 1 if self.hidden else int(bool(told) or tag not in DRAWN)
        if told:
            self.look.left_out.append(f"line {self.parser.CurrentLineNumber}: {told}")

    def _enter(self, tag: str, attributes: dict[str, str], is_misplaced: bool) -> None:
        """Take note of an element about those to come, and of what it copies."""
        moves = attributes.get("transform", "").count("(")
        own = attributes.get("id")
        element = Element(moves, own, is_misplaced=is_misplaced)
        if tag == "use":
            href = copied(attributes)
            if href and not href.startswith("#"):
                raise self._refused(
                    f'refers to "{escaped(href[:60])}"; nothing outside the file is read'
                )
            element.copies.append((href[1:], 1))  # x and y of a copy move it
            if not self.hidden:
                line = self.parser.CurrentLineNumber
                self.uses.append((f"line {line}: {called(tag, attributes)}", href[1:]))
        if own is not None:
            if own not in self.elements and tag not in (*DRAWN, ONLY_COPIED):
                self.empty.add(own)
            self.elements.setdefault(own, element)
            self.look.lines.setdefault(own, self.parser.CurrentLineNumber)
        self.open.append((tag, element))

    def _fault(self, tag: str, attributes: dict[str, str]) -> str:
        """What of an element is not read, so that no line in it can be; else empty."""
        wrong = self._fault_of_place(tag, attributes) or shape_fault(tag, attributes)
        if tag == "path" and (unread := path_fault(attributes.get("d", ""))):
            wrong = wrong or f"path data: {unread}"
        return f"{called(tag, attributes)}: {wrong}" if wrong else ""

    def _fault_of_place(self, tag: str, attributes: dict[str, str]) -> str:
        is_page = not self.open
        if LANGUAGE in attributes or (self.open and self.open[-1][1].by_language):
            return "is drawn for readers of some languages alone; take the condition away"
        if tag == "a" and self.open and self.open[-1][0] == "switch":
            return "a link in a switch is drawn in part; take the link away"
        if tag == "use" and copied(attributes)[1:] in [element.name for _, element in self.open]:
            return "copies an id that a group around it has, too; give each an id of its own"
        if tag == "svg" and not is_page:
            return "a drawing within the drawing is not read; take what it holds out of it"
        if tag == ONLY_COPIED and any(key in attributes for key in ("viewBox", "x", "y")):
            return "a symbol with a viewBox, x or y is not read; make it a group"
        style = attributes.get("style", "")
        takes = SIZES if is_page else (*TAKES.get(tag, ()),)
        if key := next(iter(declarations(style, (*MOVES, *takes))), ""):
            return f'its style has "{key}", which is not read; make it an attribute'
        transform = attributes.get("transform", "")
        if wrong := transform_fault(transform):
            return f"transform: {wrong}"
        if is_page and transform:
            return "the page itself has a transform; give it to what it holds"
        origin = origin_of({**attributes, **declarations(style, ORIGINS)})
        return f"{origin}; {NO_ORIGIN}" if origin and turns(transform) else ""

    def _check_shown(self, tag: str, attributes: dict[str, str]) -> None:
        """Refuse what its own attribute hides where a rule that is not followed may show it."""
        own = {key: attributes[key] for key in SHOWN if key in attributes}
        for key in declarations(attributes.get("style", ""), SHOWN):
            own.pop(key, None)
        if self.sheets.shows and (key := hidden_by(own)):
            raise self._refused(
                f'{called(tag, attributes)}: hidden by its {key}, and "'
                f'{escaped(self.sheets.shows)[:60]}" in <style> may show it, {BEYOND}'
            )

    def _alternative(self, attributes: dict[str, str]) -> dict[str, str]:
        """Attributes of what stands in a ``switch``, hidden unless it is what is drawn of it.

        That is the first that needs no extension; of those by language each may be.
        """
        within = self.open[-1][1]
        if within.is_drawn or "requiredExtensions" in attributes:
            return hidden(attributes)
        within.by_language |= LANGUAGE in attributes
        within.is_drawn = LANGUAGE not in attributes
        return attributes

    def _end(self, _: str) -> None:
        _, element = self.open.pop()
        self.hidden = max(self.hidden - 1, 0)
        self.look.bare.end()
        element.moved_by(element.functions)
        parent = self.open[-1][1] if self.open else self.all
        parent.count += element.count
        parent.turned += element.turned
        parent.copies += element.copies

    def _not_copied(self, name: str, why: str) -> ImportSourceError:
        line = self.look.lines.get(name)
        return refused(self.path, f'"{escaped(name[:60])}" {why}', line)
