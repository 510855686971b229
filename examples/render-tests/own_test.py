"""A test that asks more of a render test than its thresholds do."""


def test_the_ball_is_better_than_it_must_be(render_test):
    golden = render_test("renders/ball").metrics["golden"]
    assert golden["displacement_p50"] < golden["displacement_p95"] < 0.5
