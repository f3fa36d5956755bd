"""Tables and pages made from a comparison alone."""

from mpmfw.report.page import write_report
from mpmfw.report.table import COLUMNS, table

__all__ = ["COLUMNS", "table", "write_report"]
