"""What tests of several rooms share, each helper with its docstring."""

from tests.helpers.commands import Said, said
from tests.helpers.examples import examples
from tests.helpers.inside import inside
from tests.helpers.words import check_error, facts
from tests.helpers.worlds import BOX, STRAIGHT, THREE, Says, dead_end, road

__all__ = [
    "BOX", "STRAIGHT", "THREE", "Said", "Says", "check_error", "dead_end", "examples", "facts",
    "inside", "road", "said",
]  # fmt: skip
