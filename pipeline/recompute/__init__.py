"""All tows under one method: the steps in their order, and the tables that come out."""
