"""From runs to tables: statistics, pivot tables, the comparison with published numbers."""
