from liepoisson.numeric.run_options import part_of


def test_parts_report_the_fraction_of_the_whole():
    seen = []
    for k in range(4):
        listen = part_of(seen.append, k / 4, 1 / 4)
        listen(0.5)
        listen(1.0)
    assert seen == [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0]
    assert part_of(None, 0.0, 1.0) is None
