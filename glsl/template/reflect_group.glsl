    // @labels@
    {
@values@
@reflection@
        bool isMet = @is_met@;
        p = isMet ? onto : p;
        d = isMet ? mirrored : d;
    }
