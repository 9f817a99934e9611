"""Study of the trial that runs itself, beside a planned trial and the paper's sweep."""
