from mpmfw_testing import KIND_conformance


@KIND_conformance("template")
def test_conformance(check):
    check()
