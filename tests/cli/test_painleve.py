"""`liepoisson painleve`: what it prints, for people and for programs, and its exit codes."""

import json

import liepoisson as lp


def test_the_test_is_printed(command):
    code, out, err = command("painleve", "lagrange")
    assert (code, err) == (0, "")
    assert out == f"{lp.integrability.painleve_test(lp.catalog.system('lagrange'))}\n"
    assert "exponents -1, 0, 1, 2, 3, 4" in out
    assert "verdict: passes\n" in out


def test_the_test_for_programs(command):
    code, out, _ = command("painleve", "henon-heiles-kaup-kupershmidt", "--format", "json")
    assert code == 0
    record = json.loads(out)
    assert list(record) == ["system", "functions", "weights", "balances", "special", "left", "verdict", "scope"]
    assert record["verdict"] == "passes weakly"
    assert record["weights"] == [{"x": "2", "y": "2", "p_x": "3", "p_y": "3"}]
    assert [balance["exponents"] for balance in record["balances"]] == [
        ["-1", "3/2", "7/2", "6"],
        ["-7", "-1", "6", "12"],
    ]
    assert record["balances"][0]["resonances"][1] == {
        **{"exponent": "3/2", "multiplicity": 1, "kernel": 1, "conditions": []}
    }


def test_a_parameter_becomes_a_symbol(command):
    code, out, _ = command("painleve", "henon-heiles-kdv", "--free", "B")
    assert code == 0
    assert "For general values of the symbols." in out


def test_orders_of_poles(command):
    code, out, _ = command("painleve", "henon-heiles-kdv", "--weights", "1,2,2,3")
    assert code == 0
    assert "orders of poles: 1 for x; 2 for y, p_x; 3 for p_y" in out


def test_what_is_left_is_named(command):
    code, out, _ = command("painleve", "twisted-top", "--time-limit", "0.01")
    assert code == 1
    assert "left: balances with the orders" in out
    assert "verdict: undecided" in out
