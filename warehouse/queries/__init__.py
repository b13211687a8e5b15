"""Questions to finished tables: views, reports, audits, comparisons, what-if."""
