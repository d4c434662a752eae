"""The report of a run: one HTML file that needs nothing else."""

from jfto.report.page import ReportContent, report_page

__all__ = ["ReportContent", "report_page"]
