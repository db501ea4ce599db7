    // @labels@
    {
@values@
@reflection@
        bool isMet = @is_met@;
        p = isMet ? onto : p;
@result@    }
