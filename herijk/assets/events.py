"""What was made and what checks said, as events of a run whose steps are no assets of Dagster."""

from collections.abc import Iterator

import dagster as dg

Result = dg.MaterializeResult | dg.AssetCheckResult
"""What an asset returns or yields; each names its asset."""

Event = dg.AssetMaterialization | dg.AssetCheckEvaluation


def events_of(result: Result, partition: str | None = None) -> Iterator[Event]:
    """A result as the asset itself would have recorded it, for one partition where it has them."""
    if isinstance(result, dg.AssetCheckResult):
        yield _evaluation(result)
        return
    yield dg.AssetMaterialization(
        result.asset_key or "", partition=partition, metadata=result.metadata
    )
    yield from map(_evaluation, result.check_results or ())


def _evaluation(check: dg.AssetCheckResult) -> dg.AssetCheckEvaluation:
    return dg.AssetCheckEvaluation(
        asset_key=check.asset_key or dg.AssetKey(""),
        check_name=check.check_name or "",
        passed=check.passed,
        severity=check.severity,
        metadata=check.metadata or {},
    )
