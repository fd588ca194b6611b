"""The 21 geometric errors of machine tools from indirect measurements.

A campaign of readings is fitted, the model is criticised, tables for a controller are made:

    campaign = volcal.read_campaign("campaign.toml")
    result = volcal.fit(campaign)
    result.write("result")

Arrays of results are SI (m, rad, s, K); columns of readings are in the units that their names end with. Every number
equals that of the command line `volcal` to the last bit.
"""


class InputError(ValueError):
    """Something that its user can mend: a file, an option, an argument.

    str() reads "file:line: problem (remedy)".
    """

    problem: str
    remedy: str
    file: str
    line: int

    def __init__(self, problem: str, remedy: str = "", file: str = "", line: int = 0, message: str = "") -> None:
        super().__init__(message or problem)
        self.problem = problem
        self.remedy = remedy
        self.file = file
        self.line = line


from ._volcal import (  # noqa: E402  (what it raises is defined before)
    Aligned,
    Budget,
    BudgetLine,
    Campaign,
    Comparison,
    CompensatedProgram,
    Diagnosis,
    EffectFinding,
    Finding,
    LadderStep,
    Machine,
    Model,
    MonteCarlo,
    Plan,
    Readings,
    Result,
    Session,
    SessionModel,
    Setup,
    Tables,
    TriedEffect,
    __version__,
    align,
    budget,
    certificate,
    compare,
    compensate,
    diagnose,
    effect_kinds,
    fit,
    montecarlo,
    plan,
    read_campaign,
    read_diagnosis,
    read_result,
    register_effect,
    table_formats,
    tables,
    try_effect,
    unregister_effect,
    validate,
)

__all__ = [
    "Aligned",
    "Budget",
    "BudgetLine",
    "Campaign",
    "Comparison",
    "CompensatedProgram",
    "Diagnosis",
    "EffectFinding",
    "Finding",
    "InputError",
    "LadderStep",
    "Machine",
    "Model",
    "MonteCarlo",
    "Plan",
    "Readings",
    "Result",
    "Session",
    "SessionModel",
    "Setup",
    "Tables",
    "TriedEffect",
    "__version__",
    "align",
    "budget",
    "certificate",
    "compare",
    "compensate",
    "diagnose",
    "effect_kinds",
    "fit",
    "montecarlo",
    "plan",
    "read_campaign",
    "read_diagnosis",
    "read_result",
    "register_effect",
    "table_formats",
    "tables",
    "try_effect",
    "unregister_effect",
    "validate",
]
