"""What planning comes to, as notebooks show it."""

from explicable.model.plan import JointPlan, Step
from explicable.planning import TeamPlan
from explicable.search import Outcome


def test_a_notebook_is_shown_names_and_no_markup_of_theirs():
    plan = JointPlan((Step("<b>r1", ("move", "<b>r1", "<script>")),), 1)
    shown = TeamPlan(Outcome.SOLVED, plan, None, 1.0, 0.0, 1, 0.0)._repr_html_()
    assert "<li>&lt;b&gt;r1 (move &lt;b&gt;r1 &lt;script&gt;)</li>" in shown
