"""Checks for controllers of one's own, for a test or an afternoon: `check_controller`.

In pytest:

    from physim.testing import check_controller

    def test_my_controller_keeps_to_the_rules():
        assert not check_controller(MyController)
"""

from physim.testing.check import check_controller, situations
from physim.testing.rules import Finding, Rule

__all__ = ["Finding", "Rule", "check_controller", "situations"]
